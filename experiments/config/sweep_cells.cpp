// The cells of a sweep that was read.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"

namespace modcal {
namespace {

// What a value states at keys below its own; null: nothing.
const YamlNode* stated_at(const YamlNode& value, std::string_view path) {
  const YamlNode* node = &value;
  while (node != nullptr && !path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    node = node->child(std::string(path.substr(0, dot)));
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return node;
}

// The label of the outer axis would name a value that no task has.
void check_inner_axis(const SweepTable& table, std::size_t outer, std::size_t inner,
                      std::vector<Mistake>& mistakes) {
  const std::string section = table.paths[outer] + ".";
  if (!table.paths[inner].starts_with(section)) return;
  const std::string rest = table.paths[inner].substr(section.size());
  for (const std::vector<const YamlNode*>& cell : table.values) {
    if (cell[outer] == nullptr || cell[inner] == nullptr) continue;
    const YamlNode* stated = stated_at(*cell[outer], rest);
    if (stated == nullptr) continue;
    mistakes.push_back({stated->position,
                        fmt::format("{} is an axis of its own: leave it out here, or that axis out",
                                    table.paths[inner])});
    return;
  }
}

std::string text_of(const SweepTable& table, const std::vector<const YamlNode*>& cell) {
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    if (cell[i] == nullptr) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", table.paths[i], flow_text(*cell[i]));
  }
  return text;
}

}  // namespace

SweepCells SweepTable::cells() const {
  SweepCells result{paths, {}};
  for (const std::vector<const YamlNode*>& cell : values) {
    std::vector<std::string> texts;
    for (const YamlNode* value : cell) {
      texts.push_back(value == nullptr ? std::string() : flow_text(*value));
    }
    result.values.push_back(std::move(texts));
  }
  return result;
}

std::vector<std::size_t> outer_first(const std::vector<std::string>& paths) {
  std::vector<std::size_t> order(paths.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {},
                           [&paths](std::size_t i) { return std::ranges::count(paths[i], '.'); });
  return order;
}

std::vector<Mistake> mistakes_of(const SweepTable& table, std::size_t included) {
  std::vector<Mistake> mistakes;
  for (std::size_t i = 0; i < table.paths.size(); ++i) {
    for (std::size_t j = 0; j < table.paths.size(); ++j) check_inner_axis(table, i, j, mistakes);
  }
  if (included == 0) return mistakes;
  std::set<std::string> known;
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    const std::vector<const YamlNode*>& cell = table.values[i];
    const std::string text = text_of(table, cell);
    if (known.insert(text).second || i + included < table.values.size()) continue;
    const YamlNode* first = *std::ranges::find_if(cell, [](const auto* v) { return v != nullptr; });
    mistakes.push_back(
        {first->position, fmt::format("the cell {{{}}} stands in the list already, and its draw "
                                      "would count twice: leave it out",
                                      text)});
  }
  return mistakes;
}

}  // namespace modcal
