#include "experiments/kinds/benchmark/benchmark_drawing.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

// Twelve looks; further searches share the muted one.
constexpr std::array kLooks = {ColorRole::kFirst,   ColorRole::kSecond,   ColorRole::kThird,
                               ColorRole::kFourth,  ColorRole::kFifth,    ColorRole::kSixth,
                               ColorRole::kSeventh, ColorRole::kEighth,   ColorRole::kNinth,
                               ColorRole::kTenth,   ColorRole::kEleventh, ColorRole::kTwelfth};

std::size_t index_in(const std::vector<std::string>& values, const std::string& value) {
  return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
}

}  // namespace

report::Tags method_tags(const BenchmarkGrid& grid, std::size_t method) {
  return {{"objective", {grid.objectives[method]}}, {"optimizer", {grid.searches[method]}}};
}

report::Tag condition_tag(const BenchmarkGrid& grid, std::size_t condition) {
  if (condition == kAllConditions) return {"condition", {std::string(report::kEverything)}};
  return {"condition", {std::string(report::kEverything), grid.conditions[condition]}};
}

report::Series method_series(const BenchmarkGrid& grid, std::size_t method, std::size_t condition,
                             SeriesStyle style) {
  const std::string& search = grid.searches[method];
  const std::size_t place = index_in(distinct(grid.searches), search);
  const bool second_set = place >= kLooks.size() / 2;
  if (second_set && style == SeriesStyle::kLine) style = SeriesStyle::kDotted;
  report::Series series{.label = search,
                        .style = style,
                        .color = place < kLooks.size() ? kLooks[place] : ColorRole::kMuted,
                        .tags = method_tags(grid, method),
                        .hidden = condition != kAllConditions};
  if (grid.conditions.size() > 1) {
    series.tags.push_back(condition == kAllConditions
                              ? condition_tag(grid, condition)
                              : report::Tag{"condition", {grid.conditions[condition]}});
  }
  return series;
}

std::vector<report::Panel> objective_panels(
    const BenchmarkGrid& grid, const report::Axis& x, const report::Axis& y,
    const std::function<void(std::size_t method, report::Panel& panel)>& add) {
  std::vector<report::Panel> panels;
  for (const std::string& objective : distinct(grid.objectives)) {
    report::Panel panel{.title = objective, .x = x, .y = y};
    for (std::size_t method = 0; method < grid.methods.size(); ++method) {
      if (grid.objectives[method] == objective) add(method, panel);
    }
    if (!panel.series.empty()) panels.push_back(std::move(panel));
  }
  return panels;
}

report::Figure panel_figure(std::string id, std::string title, std::string caption,
                            std::vector<report::Panel> panels) {
  const std::size_t columns = std::clamp<std::size_t>(panels.size(), 1, 3);
  return {.id = std::move(id),
          .title = std::move(title),
          .caption = std::move(caption),
          .columns = columns,
          .panels = std::move(panels)};
}

std::vector<std::size_t> condition_choices(const BenchmarkGrid& grid) {
  std::vector<std::size_t> choices = {kAllConditions};
  if (grid.conditions.size() < 2) return choices;
  choices.resize(1 + grid.conditions.size());
  std::iota(choices.begin() + 1, choices.end(), std::size_t{0});
  return choices;
}

std::vector<std::size_t> spread_indices(std::size_t size, std::size_t count) {
  std::vector<std::size_t> indices;
  const std::size_t kept = std::min(size, count);
  for (std::size_t i = 0; i < kept; ++i) {
    indices.push_back(kept == 1 ? size - 1 : i * (size - 1) / (kept - 1));
  }
  return indices;
}

}  // namespace modcal
