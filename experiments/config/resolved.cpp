#include "experiments/config/resolved.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

namespace modcal {
namespace {

/// YAML's double-quoted form is JSON's.
std::string yaml_string(const std::string& text) { return nlohmann::json(text).dump(); }

std::string number_text(const OptionInfo& info, double value) {
  if (std::isnan(value)) return std::string(info.word);
  return info.unit == "1" ? fmt::format("{}", value) : fmt::format("{} {}", value, info.unit);
}

// Numbers, units and words as they were written; what would not read back so, in quotes.
std::vector<std::string> flow_items(const std::vector<std::string>& values) {
  std::vector<std::string> items;
  for (const std::string& value : values) {
    const bool plain = !value.empty() && value != "null" && value != "~" &&
                       value.find_first_of(",[]{}:#&*!|>'\"%@`\n") == std::string::npos;
    const bool percent = !value.empty() && std::isdigit(static_cast<unsigned char>(value[0])) &&
                         value.ends_with('%') &&
                         value.find_first_of(",[]{}:#\n") == std::string::npos;
    items.push_back(plain || percent ? value : yaml_string(value));
  }
  return items;
}

}  // namespace

void ResolvedWriter::line(const OptionInfo& info, const std::string& value) {
  const std::string entry = fmt::format("{}{}:{}{}", std::string(2 * level_, ' '), info.key,
                                        value.empty() ? "" : " ", value);
  yaml_ += fmt::format(
      "{:<32}  # {}{}\n", entry, info.meaning,
      info.required && value.empty() ? fmt::format(" [{}]: fill in", info.unit) : std::string());
}

void ResolvedWriter::number(const OptionInfo& info, double& value) {
  line(info, number_text(info, value));
}

void ResolvedWriter::numbers(const OptionInfo& info, std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number_text(info, value));
  line(info, fmt::format("[{}]", fmt::join(texts, ", ")));
}

void ResolvedWriter::integer(const OptionInfo& info, std::int64_t& value) {
  line(info, fmt::format("{}", value));
}

void ResolvedWriter::integers(const OptionInfo& info, std::vector<std::int64_t>& values) {
  line(info, fmt::format("[{}]", fmt::join(values, ", ")));
}

void ResolvedWriter::flag(const OptionInfo& info, bool& value) {
  line(info, value ? "true" : "false");
}

void ResolvedWriter::text(const OptionInfo& info, std::string& value) {
  line(info, info.choices.empty() ? yaml_string(value) : value);
}

void ResolvedWriter::texts(const OptionInfo& info, std::vector<std::string>& values) {
  std::vector<std::string> items;
  for (const std::string& value : values) items.push_back(yaml_string(value));
  line(info, fmt::format("[{}]", fmt::join(items, ", ")));
}

void ResolvedWriter::plugin(const OptionInfo& info, PluginSlot& slot) {
  if (slot.selected().empty()) return;
  line(info, {});
  ++level_;
  line({.key = "type", .meaning = slot.summary(slot.selected())}, std::string(slot.selected()));
  slot.visit_options(*this);
  --level_;
}

void ResolvedWriter::group(const OptionInfo& info, const VisitMembers& visit_members) {
  line(info, {});
  ++level_;
  visit_members(*this);
  --level_;
}

void ResolvedWriter::optional_group(const OptionInfo& info, bool& present,
                                    const VisitMembers& visit_members) {
  if (present) group(info, visit_members);
}

void ResolvedWriter::list(const OptionInfo& info, ListSlot& slot) {
  line(info, slot.size() == 0 ? "[]" : "");
  for (std::size_t i = 0; i < slot.size(); ++i) {
    const std::size_t start = yaml_.size();
    level_ += 2;
    slot.visit_item(i, *this);
    level_ -= 2;
    if (yaml_.size() > start) yaml_[start + 2 * level_ + 2] = '-';
  }
}

void ResolvedWriter::sweep(const OptionInfo& info, SweepSlot& slot) {
  if (slot.axes().empty()) return;
  line(info, {});
  ++level_;
  line({.key = "product", .meaning = "every combination of the values"}, {});
  ++level_;
  for (const SweepAxis& axis : slot.axes()) {
    line({.key = axis.path, .meaning = "values"},
         fmt::format("[{}]", fmt::join(flow_items(axis.values), ", ")));
  }
  level_ -= 2;
}

}  // namespace modcal
