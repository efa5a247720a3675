// A YAML file as written: every key and value with its place.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/config/complaint.hpp"

namespace modcal {

/// Place in a file or in an argument of the command line; line and column count from 1, the column
/// in bytes.
struct SourcePosition {
  std::size_t line = 1;
  std::size_t column = 1;
  /// "--set 1"; empty: the file.
  std::string origin = {};
};

/// One node of the document.
struct YamlNode {
  enum class Kind { kScalar, kSequence, kMap };
  struct Member;
  Kind kind = Kind::kScalar;
  SourcePosition position;
  std::string text;      ///< of a scalar, as written without quotes
  bool quoted = false;   ///< a quoted scalar is text, never a number
  bool refused = false;  ///< stands for what is not supported: it is a mistake already
  std::vector<YamlNode> items;
  std::vector<Member> members;

  const YamlNode* find(std::string_view key) const;
  YamlNode* find(std::string_view key);
  /// Member of a map by its key, item of a list by its index.
  const YamlNode* child(std::string_view name) const;
};

struct YamlNode::Member {
  std::string key;
  SourcePosition position;
  YamlNode value;
};

/// One mistake of a file.
struct Mistake {
  SourcePosition position;
  std::string text;
  bool warning = false;
  std::string unknown_key = {};  ///< where that is the mistake
};

struct YamlDocument {
  std::string file;                ///< as named by the user
  std::vector<std::string> lines;  ///< of the source, for carets
  /// Name and text of the arguments that have been applied, for carets.
  std::vector<std::pair<std::string, std::string>> arguments;
  YamlNode root;
  std::vector<Mistake> mistakes;  ///< found while parsing

  std::filesystem::path folder() const;
};

/// Parses without interpreting. Duplicate keys, merge keys, anchors, aliases and tags, several
/// documents, tabs in the indentation, bytes that are not UTF-8, an empty file and a top level that
/// is no map are mistakes; a syntax error is one, too. Throws InvalidInput where the file cannot be
/// read.
YamlDocument read_yaml_file(const std::filesystem::path& path);
YamlDocument parse_yaml(const std::string& source, std::string file);

/// Replaces the value at a dotted path ("scene.bow.normal_force", "figures.0.id") by `value`,
/// adding maps on the way; a plug-in given by its name alone becomes {type: name}. What is added
/// stands at `path_position`, so that a reader reports a wrong path there and a wrong value at its
/// own place.
void set_value(YamlDocument& document, std::string_view path, YamlNode value,
               const SourcePosition& path_position);

/// "key.path=value" of the command line: the value is parsed as YAML.
void apply_assignment(YamlDocument& document, std::string_view assignment, std::size_t number);

/// All mistakes, by place, each with its source line and a caret.
std::vector<Complaint> complaints_of(const YamlDocument& document, std::vector<Mistake> mistakes);
/// The same as they are printed.
std::string format_mistakes(const YamlDocument& document, const std::vector<Mistake>& mistakes);

// YAML text to a document's tree.

/// Fills root and mistakes of `document`. The first `skip` bytes of the text are no part of the
/// YAML: places count them.
void parse_yaml_text(YamlDocument& document, const std::string& text, std::size_t skip);

}  // namespace modcal
