#include "experiments/config/resolved.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cctype>
#include <cmath>

namespace modcal {
namespace {

std::string number_text(const OptionInfo& info, double value) {
  if (std::isnan(value)) return std::string(info.word);
  return info.unit == "1" ? fmt::format("{}", value) : fmt::format("{} {}", value, info.unit);
}

std::string item_text(const std::string& value) {
  const bool nested = value.starts_with('{') || value.starts_with('[');
  return nested ? value : flow_scalar(value);
}

std::string axis_text(const SweepAxis& axis) {
  std::vector<std::string> items;
  for (const std::string& value : axis.values) items.push_back(item_text(value));
  return fmt::format("[{}]", fmt::join(items, ", "));
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
  const SweepPlan& plan = slot.plan();
  if (plan.product.empty() && plan.zip.empty() && plan.include.empty()) return;
  line({.key = info.key, .meaning = info.meaning}, {});
  ++level_;
  if (!plan.product.empty()) {
    line({.key = "product", .meaning = "every combination of the values"}, {});
    ++level_;
    for (const SweepAxis& axis : plan.product) {
      line({.key = axis.path, .meaning = "values"}, axis_text(axis));
    }
    --level_;
  }
  if (!plan.zip.empty()) {
    line({.key = "zip", .meaning = "values that vary together"}, {});
    for (const std::vector<SweepAxis>& group : plan.zip) {
      std::vector<std::pair<std::string, std::string>> members;
      for (const SweepAxis& axis : group) members.emplace_back(axis.path, axis_text(axis));
      item(members);
    }
  }
  points("exclude", "cells left out", plan.exclude);
  points("include", "cells added", plan.include);
  --level_;
}

void ResolvedWriter::points(std::string_view key, std::string_view meaning,
                            const std::vector<SweepPoint>& points) {
  if (points.empty()) return;
  line({.key = key, .meaning = meaning}, {});
  for (const SweepPoint& point : points) {
    std::vector<std::pair<std::string, std::string>> members;
    for (const auto& [path, value] : point) members.emplace_back(path, item_text(value));
    item(members);
  }
}

void ResolvedWriter::item(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string_view indent = "- ";
  for (const auto& [key, value] : members) {
    yaml_ += fmt::format("{}{}{}: {}\n", std::string(2 * level_ + 2, ' '), indent, key, value);
    indent = "  ";
  }
}

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
