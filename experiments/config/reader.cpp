#include "experiments/config/reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "libsim/base/words.hpp"

namespace modcal {

YamlReader::YamlReader(const YamlNode& node, std::vector<Mistake>& mistakes)
    : node_(node), mistakes_(mistakes) {}

void YamlReader::mistake(const YamlNode& node, std::string text) {
  if (!node.refused) mistakes_.push_back({node.position, std::move(text)});
}

const YamlNode* YamlReader::take(const OptionInfo& info) {
  allow(info.key);
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
    const std::string_view moved = moved_key(member.key);
    if (moved.empty()) {
      mistakes_.push_back(
          {.position = member.position,
           .text = fmt::format("unknown key \"{}\"{}", member.key, remedy_of(member)),
           .unknown_key = member.key});
    } else {
      mistakes_.push_back({member.position, fmt::format("\"{}\" {}", member.key, moved)});
    }
  }
}

void YamlReader::read_members(const YamlNode& node, const VisitMembers& visit_members,
                              std::string_view section) {
  YamlReader inner(node, mistakes_);
  visit_members(inner);
  inner.finish();
  for (const std::string& key : inner.seen_) inner_.emplace_back(key, section);
}

// What to do about a key that is not known.
std::string YamlReader::remedy_of(const YamlNode::Member& member) const {
  const std::string& key = member.key;
  // {rate: 12,5 kHz}
  const bool has_value = kind_name(member.value) != "nothing";
  if (!has_value && key[0] >= '0' && key[0] <= '9') return std::string(kDecimalComma);
  const auto inner = std::find_if(inner_.begin(), inner_.end(),
                                  [&key](const auto& known) { return known.first == key; });
  if (inner == inner_.end()) return suggestion(key, seen_);
  return fmt::format("; it belongs to \"{}\": indent it below", inner->second);
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
  read_members(*node, visit_members, info.key);
}

void YamlReader::optional_group(const OptionInfo& info, bool& present,
                                const VisitMembers& visit_members) {
  present = node_.find(info.key) != nullptr;
  if (present) return group(info, visit_members);
  take(info);
}

bool YamlReader::select(const OptionInfo& info, const YamlNode& name, PluginSlot& slot) {
  const std::vector<std::string> names = strings_of(slot.names());
  if (name.kind != YamlNode::Kind::kScalar ||
      std::find(names.begin(), names.end(), name.text) == names.end()) {
    mistake(name, fmt::format("{}: unknown {} \"{}\"{}", info.key, slot.kind(), name.text,
                              suggestion(name.text, names)));
    return false;
  }
  // A type restated keeps the defaults that the experiment may have set.
  if (slot.selected() != name.text) slot.select(name.text);
  return true;
}

void YamlReader::plugin(const OptionInfo& info, PluginSlot& slot) {
  const YamlNode* node = take(info);
  if (node == nullptr) {
    return skip_section(info, [&slot](OptionVisitor& inner) { slot.visit_options(inner); });
  }
  YamlNode named;  // a name alone is short for {type: name}
  if (node->kind == YamlNode::Kind::kScalar) {
    named.kind = YamlNode::Kind::kMap;
    named.position = node->position;
    named.members.push_back({"type", node->position, *node});
    node = &named;
  }
  const YamlNode* type = node->find("type");
  if (node->kind != YamlNode::Kind::kMap || type == nullptr) {
    mistake(*node,
            fmt::format("{} needs a type: one of {}", info.key, fmt::join(slot.names(), ", ")));
    return;
  }
  if (!select(info, *type, slot)) return;
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
    read_members(
        item, [&slot, i](OptionVisitor& inner) { slot.visit_item(i, inner); }, info.key);
  }
}

std::vector<Mistake> YamlReader::read_cell(const YamlNode& base, const SweepTable& table,
                                           std::size_t cell, SweepSlot& slot) const {
  YamlDocument variant;
  variant.root = base;
  for (const std::size_t i : table.order) {
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

std::string_view moved_key(std::string_view key) {
  if (key != "continuation") return {};
  return "is now the optimizer \"staged\": write objective: {type: joint_likelihood, noise_rms_1, "
         "noise_rms_2, highest_frequency}, optimizer: {type: staged, restarts}, and what is free "
         "or "
         "known under parameters: {frequencies: all, law: true, contact: true, damping: factor, "
         "law_width, sensors: [gain, ...], per_record, fixed, priors, correlations}";
}

std::string suggestion(std::string_view text, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(text, names);
  if (!nearest.empty()) return fmt::format("; did you mean \"{}\"?", nearest);
  return names.empty() ? std::string() : fmt::format("; known: {}", fmt::join(names, ", "));
}

}  // namespace modcal
