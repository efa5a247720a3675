#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/config/help.hpp"

namespace modcal {
namespace {

// Numbers, units and words as they were written; what would not read back so, in quotes.
std::string flow_scalar(const std::string& text) {
  const bool plain = !text.empty() && text != "null" && text != "~" &&
                     text.find_first_of(",[]{}:#&*!|>'\"%@`\n") == std::string::npos;
  const bool percent = !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) &&
                       text.ends_with('%') && text.find_first_of(",[]{}:#\n") == std::string::npos;
  return plain || percent ? text : yaml_string(text);
}

template <typename Value>
std::string text_of(const OptionInfo& info, const Value& value) {
  if constexpr (std::is_same_v<Value, double>) {
    if (std::isnan(value)) return std::string(info.word);
    return info.unit == "1" ? fmt::format("{}", value) : fmt::format("{} {}", value, info.unit);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return info.choices.empty() ? yaml_string(value) : value;
  } else if constexpr (std::is_integral_v<Value>) {
    const bool word = !std::is_same_v<Value, bool> && value == 0 && !info.word.empty();
    return word ? std::string(info.word) : fmt::format("{}", value);
  } else {
    std::vector<std::string> items;
    for (const auto& item : value) items.push_back(text_of(info, item));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
}

// A value of a sweep as it was written, or several of them.
std::string swept_text(const std::string& value) {
  const bool nested = value.starts_with('{') || value.starts_with('[');
  return nested ? value : flow_scalar(value);
}

std::string swept_text(const std::vector<std::string>& values) {
  std::vector<std::string> items;
  for (const std::string& value : values) items.push_back(swept_text(value));
  return fmt::format("[{}]", fmt::join(items, ", "));
}

// Points, or axes that vary together.
template <typename Members>
std::string swept_maps(const std::vector<Members>& maps) {
  std::vector<std::string> items;
  for (const Members& members : maps) {
    std::vector<std::string> parts;
    for (const auto& [path, value] : members) {
      parts.push_back(fmt::format("{}: {}", path, swept_text(value)));
    }
    items.push_back(fmt::format("{{{}}}", fmt::join(parts, ", ")));
  }
  return fmt::format("[{}]", fmt::join(items, ", "));
}

}  // namespace

std::string yaml_string(const std::string& text) { return nlohmann::json(text).dump(); }

void ResolvedWriter::line(const OptionInfo& info, const std::string& value,
                          const std::string& note) {
  const std::string entry = fmt::format("{}{}:{}{}", std::string(2 * level_, ' '), info.key,
                                        value.empty() ? "" : " ", value);
  yaml_ += fmt::format("{:<32}  # {}{}{}\n", entry, info.meaning, note.empty() ? "" : " ", note);
}

void ResolvedWriter::value(const OptionInfo& info, OptionValue value) {
  const std::string text =
      std::visit([&info](const auto* held) { return text_of(info, *held); }, value);
  const bool missing = info.required && text.empty();
  line(info, text, missing ? fmt::format("[{}]: fill in", info.unit) : std::string());
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
  const SweepPlan& plan = slot.plan();
  if (plan.product.empty() && plan.zip.empty() && plan.include.empty()) return;
  line({.key = info.key, .meaning = info.meaning}, {});
  ++level_;
  if (!plan.product.empty()) {
    line({.key = "product", .meaning = "every combination of the values"}, {});
    ++level_;
    for (const SweepAxis& axis : plan.product) {
      line({.key = axis.path, .meaning = "values"}, swept_text(axis.values));
    }
    --level_;
  }
  const auto maps = [this](std::string_view key, std::string_view meaning, const auto& members) {
    if (!members.empty()) line({.key = key, .meaning = meaning}, swept_maps(members));
  };
  maps("zip", "values that vary together", plan.zip);
  maps("exclude", "cells left out", plan.exclude);
  maps("include", "cells added", plan.include);
  --level_;
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
