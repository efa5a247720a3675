#include "experiments/config/document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

SourcePosition position_of(const YAML::Mark& mark) {
  if (mark.is_null()) return {};
  return {static_cast<std::size_t>(mark.line) + 1, static_cast<std::size_t>(mark.column) + 1, {}};
}

// Builds the tree from the parser's events: unlike YAML::Node they show duplicate keys, anchors and
// the place of every key.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(YamlDocument& document) : document_(document) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    YamlNode node;
    node.position = position_of(mark);
    add(std::move(node));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "aliases (*name) are not supported: write the value out");
    YamlNode node;
    node.position = position_of(mark);
    add(std::move(node));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    YamlNode node;
    node.position = position_of(mark);
    node.text = value;
    node.quoted = tag == "!";
    if (!tag.empty() && tag != "!" && tag != "?") {
      refuse(mark, fmt::format("the tag {} is not supported: leave it out", tag));
    }
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor, YamlNode::Kind::kSequence);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor, YamlNode::Kind::kMap);
  }
  void OnMapEnd() override { close(); }

  bool has_root() const { return has_root_; }
  YamlNode take_root() { return std::move(root_); }

 private:
  struct Level {
    YamlNode node;
    bool has_key = false;
    std::string key;
    SourcePosition key_position;
  };

  void refuse(const YAML::Mark& mark, std::string text) {
    document_.mistakes.push_back({position_of(mark), std::move(text)});
  }
  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0) refuse(mark, "anchors (&name) are not supported: write the value out");
  }
  void open(const YAML::Mark& mark, YAML::anchor_t anchor, YamlNode::Kind kind) {
    refuse_anchor(mark, anchor);
    Level level;
    level.node.kind = kind;
    level.node.position = position_of(mark);
    levels_.push_back(std::move(level));
  }
  void close() {
    YamlNode node = std::move(levels_.back().node);
    levels_.pop_back();
    add(std::move(node));
  }
  void add(YamlNode node) {
    if (levels_.empty()) {
      root_ = std::move(node);
      has_root_ = true;
      return;
    }
    Level& level = levels_.back();
    if (level.node.kind == YamlNode::Kind::kSequence) {
      level.node.items.push_back(std::move(node));
    } else if (!level.has_key) {
      take_key(level, node);
    } else {
      add_member(level, std::move(node));
    }
  }
  void take_key(Level& level, const YamlNode& node) {
    level.has_key = true;
    level.key = node.text;
    level.key_position = node.position;
    if (node.kind != YamlNode::Kind::kScalar) {
      document_.mistakes.push_back({node.position, "a key must be a plain word"});
    } else if (node.text == "<<" && !node.quoted) {
      document_.mistakes.push_back(
          {node.position, "merge keys (<<) are not supported: write the values out"});
    }
  }
  void add_member(Level& level, YamlNode node) {
    level.has_key = false;
    for (const YamlNode::Member& member : level.node.members) {
      if (member.key != level.key) continue;
      document_.mistakes.push_back(
          {level.key_position, fmt::format("duplicate key \"{}\": it stands in line {} already",
                                           level.key, member.position.line)});
      return;
    }
    level.node.members.push_back({level.key, level.key_position, std::move(node)});
  }

  YamlDocument& document_;
  std::vector<Level> levels_;
  YamlNode root_;
  bool has_root_ = false;
};

std::vector<std::string> split_lines(const std::string& source) {
  std::vector<std::string> lines;
  std::istringstream stream(source);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(std::move(line));
  }
  return lines;
}

void parse_into(YamlDocument& document, const std::string& source) {
  std::istringstream stream(source);
  TreeBuilder builder(document);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    YamlDocument unused;
    TreeBuilder rest(unused);
    if (parser.HandleNextDocument(rest)) {
      document.mistakes.push_back({{1, 1}, "several YAML documents (---) in one file: keep one"});
    }
  } catch (const YAML::ParserException& error) {
    document.mistakes.push_back({position_of(error.mark), "not YAML: " + error.msg});
    return;
  }
  if (!builder.has_root()) {
    document.mistakes.push_back({{1, 1}, "the file is empty: an experiment starts with kind:"});
    return;
  }
  document.root = builder.take_root();
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  for (const Member& member : members) {
    if (member.key == key) return &member.value;
  }
  return nullptr;
}

YamlNode* YamlNode::find(std::string_view key) {
  return const_cast<YamlNode*>(std::as_const(*this).find(key));
}

std::filesystem::path YamlDocument::folder() const {
  return std::filesystem::path(file).parent_path();
}

YamlDocument parse_yaml(const std::string& source, std::string file) {
  YamlDocument document;
  document.file = std::move(file);
  document.lines = split_lines(source);
  parse_into(document, source);
  if (document.mistakes.empty() && document.root.kind != YamlNode::Kind::kMap) {
    document.mistakes.push_back(
        {document.root.position, "the file must be a map of keys and values, kind: first"});
  }
  return document;
}

YamlDocument read_yaml_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  MODCAL_REQUIRE(stream.good() && !std::filesystem::is_directory(path),
                 "{}: cannot be read: no such file, or no permission", path.string());
  std::ostringstream content;
  content << stream.rdbuf();
  return parse_yaml(content.str(), path.string());
}

void set_value(YamlDocument& document, std::string_view path, YamlNode value,
               const SourcePosition& path_position) {
  YamlNode* node = &document.root;
  while (true) {
    const std::size_t dot = path.find('.');
    const std::string key(path.substr(0, dot));
    if (key.empty() || node->kind != YamlNode::Kind::kMap) {
      document.mistakes.push_back(
          {path_position, fmt::format("the path leads to no place: \"{}\" has no keys here", key)});
      return;
    }
    YamlNode* next = node->find(key);
    if (next == nullptr) {
      YamlNode::Member member{key, path_position, {}};
      member.value.position = value.position;
      if (dot != std::string_view::npos) member.value.kind = YamlNode::Kind::kMap;
      node->members.push_back(std::move(member));
      next = &node->members.back().value;
    }
    if (dot == std::string_view::npos) {
      *next = std::move(value);
      return;
    }
    node = next;
    path.remove_prefix(dot + 1);
  }
}

namespace {

void set_origin(YamlNode& node, const std::string& origin) {
  node.position = {0, 0, origin};
  for (YamlNode& item : node.items) set_origin(item, origin);
  for (YamlNode::Member& member : node.members) {
    member.position = {0, 0, origin};
    set_origin(member.value, origin);
  }
}

}  // namespace

void apply_assignment(YamlDocument& document, std::string_view assignment, std::size_t number) {
  const std::string origin = fmt::format("command line, --set {}", number);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    document.mistakes.push_back(
        {{0, 0, origin}, fmt::format("\"{}\" is not key.path=value", assignment)});
    return;
  }
  YamlDocument value;
  parse_into(value, std::string(assignment.substr(equals + 1)) + "\n");
  for (const Mistake& mistake : value.mistakes) {
    document.mistakes.push_back({{0, 0, origin}, mistake.text});
  }
  set_origin(value.root, origin);
  set_value(document, assignment.substr(0, equals), std::move(value.root), {0, 0, origin});
}

std::string format_mistakes(const YamlDocument& document, std::vector<Mistake> mistakes) {
  std::stable_sort(mistakes.begin(), mistakes.end(), [](const Mistake& a, const Mistake& b) {
    return std::tie(a.position.line, a.position.column) <
           std::tie(b.position.line, b.position.column);
  });
  std::string text;
  for (const Mistake& mistake : mistakes) {
    const SourcePosition& at = mistake.position;
    const char* severity = mistake.warning ? "warning" : "error";
    if (!at.origin.empty()) {
      text += fmt::format("{}: {}: {}\n", at.origin, severity, mistake.text);
      continue;
    }
    text += fmt::format("{}:{}:{}: {}: {}\n", document.file, at.line, at.column, severity,
                        mistake.text);
    if (at.line >= 1 && at.line <= document.lines.size()) {
      const std::string& line = document.lines[at.line - 1];
      std::string indent = line.substr(0, std::min(line.size(), at.column - 1));
      for (char& letter : indent) letter = letter == '\t' ? '\t' : ' ';
      text += fmt::format("    {}\n    {}^\n", line, indent);
    }
  }
  return text;
}

}  // namespace modcal
