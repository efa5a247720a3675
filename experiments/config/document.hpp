// A YAML file as written: every key and value with its place.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace modcal {

/// Place in a file or on the command line; line and column count from 1, 0: none.
struct SourcePosition {
  std::size_t line = 0;
  std::size_t column = 0;
  /// Stands in the place of file, line and column where a value comes from elsewhere
  /// ("command line, --set 1").
  std::string origin = {};
};

/// One node of the document.
struct YamlNode {
  enum class Kind { kScalar, kSequence, kMap };
  struct Member;
  Kind kind = Kind::kScalar;
  SourcePosition position;
  std::string text;     ///< of a scalar, as written without quotes
  bool quoted = false;  ///< a quoted scalar is text, never a number
  std::vector<YamlNode> items;
  std::vector<Member> members;

  const YamlNode* find(std::string_view key) const;
  YamlNode* find(std::string_view key);
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
};

struct YamlDocument {
  std::string file;                ///< as named by the user
  std::vector<std::string> lines;  ///< of the source, for carets
  YamlNode root;
  std::vector<Mistake> mistakes;  ///< found while parsing

  std::filesystem::path folder() const;
};

/// Parses without interpreting. Duplicate keys, merge keys, anchors and aliases, several documents,
/// an empty file and a top level that is no map are mistakes; a syntax error is one, too.
/// Throws InvalidInput where the file cannot be read.
YamlDocument read_yaml_file(const std::filesystem::path& path);
YamlDocument parse_yaml(const std::string& source, std::string file);

/// Replaces the value at a dotted path ("scene.bow.normal_force") by `value`, adding maps on the
/// way; a mistake at `path_position` where a path leads through something that is no map.
void set_value(YamlDocument& document, std::string_view path, YamlNode value,
               const SourcePosition& path_position);

/// "key.path=value" of the command line: the value is parsed as YAML.
void apply_assignment(YamlDocument& document, std::string_view assignment, std::size_t number);

/// All mistakes, by place: "file:line:column: error: text", the source line, a caret.
std::string format_mistakes(const YamlDocument& document, std::vector<Mistake> mistakes);

}  // namespace modcal
