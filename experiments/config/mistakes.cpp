#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "experiments/config/document.hpp"
#include "experiments/config/yaml_text.hpp"

namespace modcal {
namespace {

// The file first, then the arguments in their order ("--set 2" before "--set 10").
auto order_of(const SourcePosition& position) {
  return std::make_tuple(position.origin.size(), std::string_view(position.origin), position.line,
                         position.column);
}

std::string_view source_line(const YamlDocument& document, const SourcePosition& at) {
  for (const auto& [origin, text] : document.arguments) {
    if (origin == at.origin) return text;
  }
  const bool in_file = at.origin.empty() && at.line >= 1 && at.line <= document.lines.size();
  return in_file ? std::string_view(document.lines[at.line - 1]) : std::string_view();
}

std::string format_mistake(const YamlDocument& document, const Mistake& mistake) {
  const SourcePosition& at = mistake.position;
  const std::string_view line = source_line(document, at);
  const std::string_view before = line.substr(0, std::min(line.size(), at.column - 1));
  // Columns count characters, tabs stay tabs: the caret stands below its place.
  std::string indent;
  for (const char byte : before) {
    if (count_characters({&byte, 1}) == 1) indent += byte == '\t' ? '\t' : ' ';
  }
  const std::string place = at.origin.empty() ? fmt::format("{}:{}:{}", document.file, at.line,
                                                            count_characters(before) + 1)
                                              : at.origin;
  std::string text =
      fmt::format("{}: {}: {}\n", place, mistake.warning ? "warning" : "error", mistake.text);
  if (!line.empty()) text += fmt::format("    {}\n    {}^\n", line, indent);
  return text;
}

}  // namespace

std::string format_mistakes(const YamlDocument& document, std::vector<Mistake> mistakes) {
  std::stable_sort(mistakes.begin(), mistakes.end(), [](const Mistake& a, const Mistake& b) {
    return order_of(a.position) < order_of(b.position);
  });
  std::string text;
  for (const Mistake& mistake : mistakes) text += format_mistake(document, mistake);
  return text;
}

}  // namespace modcal
