#include "experiments/config/flow_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <nlohmann/json.hpp>

namespace modcal {

std::string yaml_string(const std::string& text) { return nlohmann::json(text).dump(); }

std::string flow_scalar(const std::string& text) {
  const bool plain = !text.empty() && text != "null" && text != "~" &&
                     text.find_first_of(",[]{}:#&*!|>'\"%@`\n") == std::string::npos;
  const bool percent = !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) &&
                       text.ends_with('%') && text.find_first_of(",[]{}:#\n") == std::string::npos;
  return plain || percent ? text : yaml_string(text);
}

std::string flow_text(const YamlNode& node) {
  std::vector<std::string> parts;
  switch (node.kind) {
    case YamlNode::Kind::kMap:
      for (const YamlNode::Member& member : node.members) {
        const bool scalar = member.value.kind == YamlNode::Kind::kScalar;
        parts.push_back(
            fmt::format("{}: {}", member.key,
                        scalar ? flow_scalar(member.value.text) : flow_text(member.value)));
      }
      return fmt::format("{{{}}}", fmt::join(parts, ", "));
    case YamlNode::Kind::kSequence:
      for (const YamlNode& item : node.items) {
        const bool scalar = item.kind == YamlNode::Kind::kScalar;
        parts.push_back(scalar ? flow_scalar(item.text) : flow_text(item));
      }
      return fmt::format("[{}]", fmt::join(parts, ", "));
    default:
      return node.text;
  }
}

}  // namespace modcal
