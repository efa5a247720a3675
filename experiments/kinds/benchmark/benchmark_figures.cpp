// Errors, cost and convergence of a benchmark, and what its figures have in common.

#include <numeric>

#include "experiments/kinds/benchmark/benchmark.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

// Twelve looks; further searches share the muted one.
constexpr std::array kLooks = {ColorRole::kFirst,   ColorRole::kSecond,   ColorRole::kThird,
                               ColorRole::kFourth,  ColorRole::kFifth,    ColorRole::kSixth,
                               ColorRole::kSeventh, ColorRole::kEighth,   ColorRole::kNinth,
                               ColorRole::kTenth,   ColorRole::kEleventh, ColorRole::kTwelfth};

// Cells of a method with an estimate, by rising noise.
std::vector<const BenchmarkCell*> cells_of(const BenchmarkGrid& grid,
                                           const std::vector<BenchmarkCell>& cells,
                                           std::size_t method) {
  std::vector<const BenchmarkCell*> line;
  for (const BenchmarkCell& cell : cells) {
    if (cell.method == method && std::isfinite(cell.rms.median)) line.push_back(&cell);
  }
  std::stable_sort(line.begin(), line.end(), [&grid](const auto* a, const auto* b) {
    return grid.noise_levels[a->condition] < grid.noise_levels[b->condition];
  });
  return line;
}

// The bound of one method against noise: that of all methods with the same unknowns.
report::Series bound_series(const BenchmarkGrid& grid,
                            const std::vector<const BenchmarkCell*>& line) {
  report::Series series{.label = "Cramér–Rao bound",
                        .style = SeriesStyle::kLineWithPoints,
                        .color = ColorRole::kReference};
  for (const BenchmarkCell* cell : line) {
    if (std::isfinite(cell->bound)) {
      series.add(100.0 * grid.noise_levels[cell->condition], cell->bound);
    }
  }
  return series;
}

// Few of the points, evenly in the logarithm of the evaluations: later ones come closer together.
std::vector<std::size_t> trace_points(const BenchmarkOutcome& outcome, std::size_t most) {
  std::vector<std::size_t> kept;
  const double last = std::log(static_cast<double>(outcome.trace.back().first) + 1.0);
  double next = -1.0;
  for (std::size_t i = 0; i < outcome.trace.size(); ++i) {
    const double place = std::log(static_cast<double>(outcome.trace[i].first) + 1.0);
    if (place < next && i + 1 < outcome.trace.size()) continue;
    kept.push_back(i);
    next = place + last / static_cast<double>(most);
  }
  return kept;
}

report::Series trace_series(const BenchmarkGrid& grid, const BenchmarkTask& task, bool is_first) {
  report::Series series = method_series(
      grid, task.method, is_first ? kAllConditions : task.condition, SeriesStyle::kLine);
  if (is_first && grid.conditions.size() > 1) {
    series.tags.back() = condition_tag(grid, task.condition);
  }
  for (const std::size_t i : trace_points(task.outcome, is_first ? 60 : 24)) {
    const auto& [evaluations, value] = task.outcome.trace[i];
    const double ratio = value / task.outcome.truth_value;
    add_task(series, static_cast<double>(evaluations),
             ratio > 0.0 ? ratio : std::numeric_limits<double>::quiet_NaN(),
             static_cast<std::int64_t>(task.task));
  }
  return series;
}

}  // namespace

std::string draws_text(const BenchmarkGrid& grid) {
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> counts;
  for (const BenchmarkTask& task : grid.tasks) ++counts[{task.method, task.condition}];
  if (counts.empty()) return "no draws";
  const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
  const auto [least, most] = std::minmax_element(counts.begin(), counts.end(), fewer);
  return least->second == most->second ? fmt::format("{} draws", most->second)
                                       : fmt::format("{} to {} draws", least->second, most->second);
}

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
  const std::size_t place = place_in(distinct(grid.searches), search);
  const bool second_set = place >= kLooks.size() / 2;
  if (second_set && style == SeriesStyle::kLine) style = SeriesStyle::kDashed;
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

report::Figure panel_figure(report::Figure figure, std::vector<report::Panel> panels) {
  figure.columns = std::clamp<std::size_t>(panels.size(), 1, 3);
  figure.panels = std::move(panels);
  return figure;
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

report::Figure error_figure(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells) {
  const auto add = [&](std::size_t method, report::Panel& panel) {
    const auto line = cells_of(grid, cells, method);
    if (panel.series.empty()) add_drawn(panel, bound_series(grid, line));
    report::Series series =
        method_series(grid, method, kAllConditions, SeriesStyle::kLineWithPoints);
    // Every noise level is in the line: no condition filters it.
    if (grid.conditions.size() > 1) series.tags.pop_back();
    for (const BenchmarkCell* cell : line) {
      add_band(series, 100.0 * grid.noise_levels[cell->condition], cell->rms);
      series.tasks.push_back(cell->task);
    }
    add_drawn(panel, std::move(series));
  };
  return panel_figure(
      {.id = "error_against_noise",
       .title = "Frequency error against noise",
       .caption = fmt::format(
           "Root mean square over the excited modes: median and band from 10 % to 90 % of {} a "
           "point. The bound is that of both reactions with the force unknown: no unbiased "
           "estimate has a smaller error.",
           draws_text(grid))},
      objective_panels(grid, {.label = "noise", .unit = "%"},
                       {.label = "relative rms error of f_n", .logarithmic = true}, add));
}

report::Figure work_precision_figure(const BenchmarkGrid& grid,
                                     const std::vector<BenchmarkCell>& cells) {
  const auto add = [&](std::size_t method, report::Panel& panel) {
    for (const std::size_t condition : condition_choices(grid)) {
      report::Series series = method_series(grid, method, condition, SeriesStyle::kPoints);
      for (const BenchmarkCell* cell : cells_of(grid, cells, method)) {
        if (condition != kAllConditions && cell->condition != condition) continue;
        add_task(series, cell->seconds, cell->rms.median, cell->task);
      }
      add_drawn(panel, std::move(series));
    }
  };
  return panel_figure(
      {.id = "work_precision",
       .title = "Error against time",
       .caption =
           fmt::format("One point a method and condition, medians over {}.", draws_text(grid))},
      objective_panels(grid, {.label = "time, median", .unit = "s", .logarithmic = true},
                       {.label = "relative rms error of f_n", .logarithmic = true}, add));
}

report::Figure trace_figure(const BenchmarkGrid& grid) {
  const std::size_t first = grid.conditions.size() / 2;
  const auto add = [&](std::size_t method, report::Panel& panel) {
    std::vector<bool> drawn(grid.conditions.size(), false);
    for (const BenchmarkTask& task : grid.tasks) {
      if (task.method != method || drawn[task.condition] || task.outcome.trace.empty()) continue;
      drawn[task.condition] = true;
      panel.series.push_back(trace_series(grid, task, task.condition == first));
    }
  };
  return panel_figure(
      {.id = "traces",
       .title = "Convergence",
       .caption = fmt::format("One draw a method and condition, at first at {}; below 1 the "
                              "objective prefers a wrong model.",
                              grid.conditions[first])},
      objective_panels(grid, {.label = "evaluations", .logarithmic = true},
                       {.label = "best value / value at the truth", .logarithmic = true}, add));
}

}  // namespace modcal
