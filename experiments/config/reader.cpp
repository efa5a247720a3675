#include "experiments/config/reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>
#include <tuple>

#include "experiments/config/nearest_name.hpp"
#include "experiments/config/scalar.hpp"
#include "experiments/config/sweep_reader.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::vector<std::string> strings_of(const std::vector<std::string_view>& views) {
  return {views.begin(), views.end()};
}

std::string_view kind_name(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kMap:
      return "a map";
    case YamlNode::Kind::kSequence:
      return "a list";
    default:
      return node.text.empty() && !node.quoted ? "nothing" : "a single value";
  }
}

}  // namespace

std::string suggestion(std::string_view text, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(text, names);
  if (!nearest.empty()) return fmt::format("; did you mean \"{}\"?", nearest);
  return names.empty() ? std::string() : fmt::format("; known: {}", fmt::join(names, ", "));
}

YamlReader::YamlReader(const YamlNode& node, std::vector<Mistake>& mistakes)
    : node_(node), mistakes_(mistakes) {}

void YamlReader::mistake(const YamlNode& node, std::string text) {
  if (!node.refused) mistakes_.push_back({node.position, std::move(text)});
}

const YamlNode* YamlReader::take(const OptionInfo& info) {
  seen_.emplace_back(info.key);
  const YamlNode* value = node_.find(info.key);
  if (value == nullptr && info.required) {
    missing_.emplace_back(info.key);
    mistake(node_, fmt::format("missing key \"{}\": {}{}", info.key, info.meaning,
                               info.unit == "1" ? std::string() : fmt::format(" [{}]", info.unit)));
  }
  return value;
}

void YamlReader::finish() {
  for (const YamlNode::Member& member : node_.members) {
    if (std::find(seen_.begin(), seen_.end(), member.key) != seen_.end()) continue;
    if (member.key == "<<") continue;  // reported by the parser
    mistakes_.push_back({member.position, fmt::format("unknown key \"{}\"{}", member.key,
                                                      suggestion(member.key, seen_))});
  }
}

bool YamlReader::read_number(const OptionInfo& info, const YamlNode& node, double& value) {
  if (node.kind != YamlNode::Kind::kScalar || node.quoted) {
    mistake(node, fmt::format("{} must be a number{}, not {}", info.key,
                              info.unit == "1" ? "" : fmt::format(" in {}", info.unit),
                              node.quoted ? "a quoted text" : kind_name(node)));
    return false;
  }
  if (!info.word.empty() && node.text == info.word) {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  const ScalarNumber number = parse_number(node.text, info.unit);
  if (!number.error.empty()) {
    mistake(node, fmt::format("{}: {}{}", info.key, number.error,
                              info.word.empty() ? "" : fmt::format(" (or {})", info.word)));
    return false;
  }
  if (!info.range.contains(number.value)) {
    mistake(node, fmt::format(
                      "{} is {}{}: it must be {}", info.key, node.text,
                      info.unit == "1" || node.text.find(' ') != std::string::npos
                          ? ""
                          : fmt::format(" {}", info.unit),
                      info.range.text() + (info.unit == "1" ? "" : fmt::format(" {}", info.unit))));
    return false;
  }
  value = number.value;
  return true;
}

bool YamlReader::read_integer(const OptionInfo& info, const YamlNode& node, std::int64_t& value) {
  const std::string& text = node.text;
  std::int64_t parsed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
  const bool whole = node.kind == YamlNode::Kind::kScalar && !node.quoted && error == std::errc() &&
                     end == text.data() + text.size();
  if (!whole) {
    mistake(node, fmt::format("{} must be a whole number, not {}", info.key,
                              node.kind == YamlNode::Kind::kScalar ? fmt::format("\"{}\"", text)
                                                                   : std::string(kind_name(node))));
    return false;
  }
  if (looks_octal(text)) {
    mistake(node,
            fmt::format("{}: \"{}\" looks octal: write it without the leading 0", info.key, text));
    return false;
  }
  if (!info.range.contains(static_cast<double>(parsed))) {
    mistake(node, fmt::format("{} is {}: it must be {}", info.key, text, info.range.text()));
    return false;
  }
  value = parsed;
  return true;
}

bool YamlReader::read_text(const OptionInfo& info, const YamlNode& node, std::string& value) {
  if (node.kind != YamlNode::Kind::kScalar || (node.text.empty() && !node.quoted)) {
    mistake(node, fmt::format("{} must be a text, not {}", info.key, kind_name(node)));
    return false;
  }
  const auto& choices = info.choices;
  if (!choices.empty() && std::find(choices.begin(), choices.end(), node.text) == choices.end()) {
    mistake(node, fmt::format("{}: \"{}\" is not one of {}{}", info.key, node.text,
                              fmt::join(choices, ", "),
                              nearest_name(node.text, strings_of(choices)).empty()
                                  ? ""
                                  : suggestion(node.text, strings_of(choices))));
    return false;
  }
  value = node.text;
  return true;
}

void YamlReader::number(const OptionInfo& info, double& value) {
  if (const YamlNode* node = take(info)) read_number(info, *node, value);
}

void YamlReader::integer(const OptionInfo& info, std::int64_t& value) {
  if (const YamlNode* node = take(info)) read_integer(info, *node, value);
}

void YamlReader::text(const OptionInfo& info, std::string& value) {
  if (const YamlNode* node = take(info)) read_text(info, *node, value);
}

template <typename Value, typename Read>
void YamlReader::read_list(const OptionInfo& info, std::vector<Value>& values, Read read) {
  const YamlNode* node = take(info);
  if (node == nullptr) return;
  values.clear();
  if (node->kind == YamlNode::Kind::kScalar && !(node->text.empty() && !node->quoted)) {
    Value value{};  // a single value is a list of one
    if (read(*node, value)) values.push_back(std::move(value));
    return;
  }
  if (node->kind != YamlNode::Kind::kSequence) {
    mistake(*node, fmt::format("{} must be a list, not {}", info.key, kind_name(*node)));
    return;
  }
  if (node->items.empty() && info.required) {
    mistake(*node, fmt::format("{} is an empty list", info.key));
  }
  for (const YamlNode& item : node->items) {
    Value value{};
    if (read(item, value)) values.push_back(std::move(value));
  }
}

void YamlReader::numbers(const OptionInfo& info, std::vector<double>& values) {
  read_list(info, values,
            [&](const YamlNode& node, double& value) { return read_number(info, node, value); });
}

void YamlReader::integers(const OptionInfo& info, std::vector<std::int64_t>& values) {
  read_list(info, values, [&](const YamlNode& node, std::int64_t& value) {
    return read_integer(info, node, value);
  });
}

void YamlReader::texts(const OptionInfo& info, std::vector<std::string>& values) {
  read_list(info, values,
            [&](const YamlNode& node, std::string& value) { return read_text(info, node, value); });
}

void YamlReader::flag(const OptionInfo& info, bool& value) {
  const YamlNode* node = take(info);
  if (node == nullptr) return;
  if (node->kind == YamlNode::Kind::kScalar && !node->quoted &&
      (node->text == "true" || node->text == "false")) {
    value = node->text == "true";
    return;
  }
  mistake(*node, fmt::format("{} must be true or false, not \"{}\"", info.key, node->text));
}

void YamlReader::read_members(const YamlNode& node, const VisitMembers& visit_members) {
  YamlReader inner(node, mistakes_);
  visit_members(inner);
  inner.finish();
}

void YamlReader::skip_section(const OptionInfo& info, const VisitMembers& visit_members) {
  YamlNode nothing;
  nothing.kind = YamlNode::Kind::kMap;
  std::vector<Mistake> unused;
  YamlReader inner(nothing, unused);
  visit_members(inner);
  if (inner.missing_.empty() || info.required) return;
  missing_.emplace_back(info.key);
  mistake(node_, fmt::format("missing key \"{}\": {}; it needs {}", info.key, info.meaning,
                             fmt::join(inner.missing_, ", ")));
}

void YamlReader::group(const OptionInfo& info, const VisitMembers& visit_members) {
  const YamlNode* node = take(info);
  if (node == nullptr) return skip_section(info, visit_members);
  if (node->kind != YamlNode::Kind::kMap) {
    mistake(*node,
            fmt::format("{} must be a map of keys and values, not {}", info.key, kind_name(*node)));
    return;
  }
  read_members(*node, visit_members);
}

void YamlReader::optional_group(const OptionInfo& info, bool& present,
                                const VisitMembers& visit_members) {
  present = node_.find(info.key) != nullptr;
  if (present) return group(info, visit_members);
  take(info);
}

void YamlReader::select(const OptionInfo& info, const YamlNode& name, PluginSlot& slot) {
  const std::vector<std::string> names = strings_of(slot.names());
  if (name.kind != YamlNode::Kind::kScalar ||
      std::find(names.begin(), names.end(), name.text) == names.end()) {
    mistake(name, fmt::format("{}: unknown {} \"{}\"{}", info.key, slot.kind(), name.text,
                              suggestion(name.text, names)));
    return;
  }
  // A type restated keeps the defaults that the experiment may have set.
  if (slot.selected() != name.text) slot.select(name.text);
}

void YamlReader::plugin(const OptionInfo& info, PluginSlot& slot) {
  const YamlNode* node = take(info);
  if (node == nullptr) {
    return skip_section(info, [&slot](OptionVisitor& inner) { slot.visit_options(inner); });
  }
  if (node->kind == YamlNode::Kind::kScalar) {
    const std::size_t before = mistakes_.size();
    select(info, *node, slot);
    if (mistakes_.size() > before) return;
    YamlNode no_options;  // so that required options of the plug-in are asked for
    no_options.kind = YamlNode::Kind::kMap;
    no_options.position = node->position;
    read_members(no_options, [&slot](OptionVisitor& inner) { slot.visit_options(inner); });
    return;
  }
  const YamlNode* type = node->find("type");
  if (node->kind != YamlNode::Kind::kMap || type == nullptr) {
    mistake(*node,
            fmt::format("{} needs a type: one of {}", info.key, fmt::join(slot.names(), ", ")));
    return;
  }
  const std::size_t before = mistakes_.size();
  select(info, *type, slot);
  if (mistakes_.size() > before) return;
  YamlReader inner(*node, mistakes_);
  inner.allow("type");
  slot.visit_options(inner);
  inner.finish();
}

void YamlReader::list(const OptionInfo& info, ListSlot& slot) {
  const YamlNode* node = take(info);
  if (node == nullptr) return;
  if (node->kind != YamlNode::Kind::kSequence) {
    mistake(*node, fmt::format("{} must be a list, not {}", info.key, kind_name(*node)));
    return;
  }
  slot.resize(node->items.size());
  for (std::size_t i = 0; i < node->items.size(); ++i) {
    const YamlNode& item = node->items[i];
    if (item.kind != YamlNode::Kind::kMap) {
      mistake(item, fmt::format("each of {} must be a map, not {}", info.key, kind_name(item)));
      continue;
    }
    read_members(item, [&slot, i](OptionVisitor& inner) { slot.visit_item(i, inner); });
  }
}

std::vector<Mistake> YamlReader::read_cell(const YamlNode& base, const SweepTable& table,
                                           std::size_t cell, SweepSlot& slot) const {
  YamlDocument variant;
  variant.root = base;
  for (std::size_t i = 0; i < table.paths.size(); ++i) {
    const YamlNode* value = table.values[cell][i];
    if (value != nullptr) set_value(variant, table.paths[i], *value, table.places[i]);
  }
  std::vector<Mistake> found = std::move(variant.mistakes);
  YamlReader reader(variant.root, found);
  reader.allow_all_known(*this);
  slot.visit_cell(cell, reader);
  reader.finish();
  return found;
}

void YamlReader::read_cells(std::string_view key, const SweepTable& table, SweepSlot& slot) {
  // Every cell starts from a copy of all but the sweep, which is as long as there are cells.
  YamlNode base = node_;
  std::erase_if(base.members, [&](const YamlNode::Member& member) { return member.key == key; });
  // A value is read once per cell that holds it; its mistake is one mistake.
  std::set<std::tuple<std::size_t, std::size_t, std::string>> known;
  const auto is_new = [&known](const Mistake& mistake) {
    return known.emplace(mistake.position.line, mistake.position.column, mistake.text).second;
  };
  for (const Mistake& mistake : mistakes_) is_new(mistake);
  for (std::size_t cell = 0; cell < table.values.size(); ++cell) {
    for (Mistake& mistake : read_cell(base, table, cell, slot)) {
      if (is_new(mistake)) mistakes_.push_back(std::move(mistake));
    }
  }
}

void YamlReader::sweep(const OptionInfo& info, SweepSlot& slot) {
  const YamlNode* node = take(info);
  if (node == nullptr) return;
  const SweepTable table = read_sweep(*node, info.key, mistakes_);
  if (table.values.empty()) return;
  slot.set_cells(table.plan, table.cells());
  read_cells(info.key, table, slot);
}

void read_options(const YamlNode& node, const std::function<void(OptionVisitor&)>& visit,
                  std::vector<Mistake>& mistakes, const std::vector<std::string>& allowed) {
  YamlReader reader(node, mistakes);
  for (const std::string& key : allowed) reader.allow(key);
  visit(reader);
  reader.finish();
}

}  // namespace modcal
