// Values put into a document from elsewhere: sweeps and the command line.
#include <fmt/format.h>

#include <charconv>

#include "experiments/config/document.hpp"
#include "experiments/config/yaml_text.hpp"

namespace modcal {
namespace {

void refuse(YamlDocument& document, const SourcePosition& position, std::string text) {
  document.mistakes.push_back({position, std::move(text)});
}

/// The item that a path's segment names by its index; null with a mistake where there is none.
YamlNode* find_item(YamlDocument& document, YamlNode& list, const std::string& key,
                    const SourcePosition& position) {
  std::size_t index = 0;
  const char* end = key.data() + key.size();
  const auto read = std::from_chars(key.data(), end, index);
  if (read.ec == std::errc() && read.ptr == end && index < list.items.size()) {
    return &list.items[index];
  }
  refuse(document, position,
         fmt::format("the list has no item \"{}\": it has {}, which count from 0", key,
                     list.items.size()));
  return nullptr;
}

/// "regularizer: water_level" is short for "regularizer: {type: water_level}".
void unfold_plugin(YamlNode& node, const SourcePosition& position) {
  if (node.kind != YamlNode::Kind::kScalar) return;
  YamlNode map;
  map.kind = YamlNode::Kind::kMap;
  map.position = position;
  if (!node.text.empty()) map.members.push_back({"type", position, std::move(node)});
  node = std::move(map);
}

YamlNode* step_into(YamlDocument& document, YamlNode& node, const std::string& key,
                    const SourcePosition& position) {
  if (node.kind == YamlNode::Kind::kSequence) return find_item(document, node, key, position);
  unfold_plugin(node, position);
  if (YamlNode* known = node.find(key)) return known;
  node.members.push_back({key, position, {}});
  node.members.back().value.position = position;
  return &node.members.back().value;
}

void set_origin(YamlNode& node, const std::string& origin) {
  node.position.origin = origin;
  for (YamlNode& item : node.items) set_origin(item, origin);
  for (YamlNode::Member& member : node.members) {
    member.position.origin = origin;
    set_origin(member.value, origin);
  }
}

}  // namespace

void set_value(YamlDocument& document, std::string_view path, YamlNode value,
               const SourcePosition& path_position) {
  const bool has_empty_key = path.empty() || path.front() == '.' || path.back() == '.' ||
                             path.find("..") != std::string_view::npos;
  if (has_empty_key) {
    return refuse(
        document, path_position,
        fmt::format("\"{}\" is no path of an option: write its keys from the top with dots "
                    "between, as in scene.bow.position",
                    path));
  }
  YamlNode* node = &document.root;
  for (std::string_view rest = path; node != nullptr;) {
    const std::size_t dot = rest.find('.');
    node = step_into(document, *node, std::string(rest.substr(0, dot)), path_position);
    if (dot == std::string_view::npos) break;
    rest.remove_prefix(dot + 1);
  }
  if (node != nullptr) *node = std::move(value);
}

void apply_assignment(YamlDocument& document, std::string_view assignment, std::size_t number) {
  const SourcePosition start{1, 1, fmt::format("command line, --set {}", number)};
  document.arguments.emplace_back(start.origin, assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0 ||
      assignment.find_first_not_of(' ', equals + 1) == std::string_view::npos) {
    return refuse(document, start, fmt::format("\"{}\" is not key.path=value", assignment));
  }
  YamlDocument value;
  parse_yaml_text(value, std::string(assignment), equals + 1);
  for (Mistake& mistake : value.mistakes) {
    mistake.position.origin = start.origin;
    document.mistakes.push_back(std::move(mistake));
  }
  // A file that could not be parsed has no options to set; that is its mistake.
  if (!value.mistakes.empty() || document.root.kind != YamlNode::Kind::kMap) return;
  set_origin(value.root, start.origin);
  set_value(document, assignment.substr(0, equals), std::move(value.root), start);
}

}  // namespace modcal
