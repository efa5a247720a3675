#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "experiments/kinds/benchmark_report.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

// Colours serve seven methods; further ones share the muted one.
ColorRole color_of(std::size_t method) {
  constexpr std::size_t kDistinct = static_cast<std::size_t>(ColorRole::kSixth);
  return method < kDistinct ? static_cast<ColorRole>(method + 1) : ColorRole::kMuted;
}

report::Series series_of(const BenchmarkGrid& grid, std::size_t method, SeriesStyle style) {
  return {.label = grid.methods[method], .style = style, .color = color_of(method)};
}

// Share of `all` that each rising value brings, as steps.
void add_steps(std::vector<double> values, std::size_t all, report::Series& series) {
  std::sort(values.begin(), values.end());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double before = static_cast<double>(i) / static_cast<double>(all);
    series.x.insert(series.x.end(), 2, values[i]);
    series.y.push_back(before);
    series.y.push_back(static_cast<double>(i + 1) / static_cast<double>(all));
  }
}

std::size_t tasks_of(const BenchmarkGrid& grid, std::size_t method) {
  return static_cast<std::size_t>(
      std::count_if(grid.tasks.begin(), grid.tasks.end(),
                    [method](const BenchmarkTask& task) { return task.method == method; }));
}

using Problem = std::pair<std::size_t, std::string>;  // condition and replicate

}  // namespace

report::Figure error_figure(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells) {
  report::Panel panel{.x = {.label = "noise", .unit = "%"},
                      .y = {.label = "median relative frequency error", .logarithmic = true}};
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    report::Series series = series_of(grid, method, SeriesStyle::kLineWithPoints);
    std::vector<const BenchmarkCell*> line;
    for (const BenchmarkCell& cell : cells) {
      if (cell.method == method && std::isfinite(cell.error)) line.push_back(&cell);
    }
    std::stable_sort(line.begin(), line.end(), [&grid](const auto* a, const auto* b) {
      return grid.noise_levels[a->condition] < grid.noise_levels[b->condition];
    });
    for (const BenchmarkCell* cell : line) {
      series.x.push_back(100.0 * grid.noise_levels[cell->condition]);
      series.y.push_back(cell->error);
      series.y_low.push_back(cell->error_q10);
      series.y_high.push_back(cell->error_q90);
    }
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  return {.id = "error_against_noise",
          .title = "Frequency error against noise",
          .caption = "Median and band from 10 % to 90 % of the draws, excited modes.",
          .panels = {std::move(panel)}};
}

report::Figure data_profile(const BenchmarkGrid& grid) {
  report::Panel panel{.x = {.label = "evaluations", .logarithmic = true},
                      .y = {.label = "share of tasks solved", .range = {{0.0, 1.0}}}};
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    report::Series series = series_of(grid, method, SeriesStyle::kLine);
    std::vector<double> spent;
    for (const BenchmarkTask& task : grid.tasks) {
      if (task.method == method && task.outcome.success) {
        spent.push_back(static_cast<double>(task.outcome.evaluations));
      }
    }
    add_steps(std::move(spent), tasks_of(grid, method), series);
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  return {.id = "data_profile",
          .title = "Tasks solved against evaluations",
          .caption = "Solved: right by the truth, when the search ended.",
          .panels = {std::move(panel)}};
}

report::Figure performance_profile(const BenchmarkGrid& grid) {
  std::map<Problem, double> fastest;
  for (const BenchmarkTask& task : grid.tasks) {
    if (!task.outcome.success) continue;
    const auto spent = static_cast<double>(task.outcome.evaluations);
    const auto [known, is_new] = fastest.try_emplace({task.condition, task.replicate}, spent);
    if (!is_new) known->second = std::min(known->second, spent);
  }
  report::Panel panel{
      .x = {.label = "evaluations / those of the fastest method", .logarithmic = true},
      .y = {.label = "share of problems solved", .range = {{0.0, 1.0}}}};
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    report::Series series = series_of(grid, method, SeriesStyle::kLine);
    std::vector<double> ratios;
    for (const BenchmarkTask& task : grid.tasks) {
      if (task.method != method || !task.outcome.success) continue;
      ratios.push_back(static_cast<double>(task.outcome.evaluations) /
                       fastest.at({task.condition, task.replicate}));
    }
    add_steps(std::move(ratios), tasks_of(grid, method), series);
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  return {.id = "performance_profile",
          .title = "Problems solved against the fastest method",
          .panels = {std::move(panel)}};
}

report::Figure work_precision_figure(const BenchmarkGrid& grid,
                                     const std::vector<BenchmarkCell>& cells) {
  report::Panel panel{.x = {.label = "time, median", .unit = "s", .logarithmic = true},
                      .y = {.label = "median relative frequency error", .logarithmic = true}};
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    report::Series series = series_of(grid, method, SeriesStyle::kPoints);
    for (const BenchmarkCell& cell : cells) {
      if (cell.method != method || !std::isfinite(cell.error)) continue;
      series.x.push_back(cell.seconds);
      series.y.push_back(cell.error);
    }
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  return {.id = "work_precision",
          .title = "Error against time",
          .caption = "One point a method and condition.",
          .panels = {std::move(panel)}};
}

report::Figure waterfall_figure(const BenchmarkGrid& grid) {
  report::Panel panel{.x = {.label = "draw, in the order of its error"},
                      .y = {.label = "relative frequency error", .logarithmic = true}};
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    report::Series series = series_of(grid, method, SeriesStyle::kLine);
    for (const BenchmarkTask& task : grid.tasks) {
      if (task.method == method && task.outcome.frequency_error > 0.0) {
        series.y.push_back(task.outcome.frequency_error);
      }
    }
    std::sort(series.y.begin(), series.y.end());
    for (std::size_t i = 0; i < series.y.size(); ++i) {
      series.x.push_back(static_cast<double>(i + 1));
    }
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  return {.id = "waterfall", .title = "Errors of all draws", .panels = {std::move(panel)}};
}

report::Figure trace_figure(const BenchmarkGrid& grid) {
  report::Panel panel{.x = {.label = "evaluations", .logarithmic = true},
                      .y = {.label = "best value / value at the truth", .logarithmic = true}};
  const std::size_t condition = grid.conditions.size() / 2;
  std::vector<bool> drawn(grid.methods.size(), false);
  for (const BenchmarkTask& task : grid.tasks) {
    if (task.condition != condition || drawn[task.method] || task.outcome.trace.empty()) continue;
    drawn[task.method] = true;
    report::Series series = series_of(grid, task.method, SeriesStyle::kLine);
    for (const auto& [evaluations, value] : task.outcome.trace) {
      const double ratio = value / task.outcome.truth_value;
      series.x.push_back(static_cast<double>(evaluations));
      series.y.push_back(ratio > 0.0 ? ratio : std::numeric_limits<double>::quiet_NaN());
    }
    panel.series.push_back(std::move(series));
  }
  return {.id = "traces",
          .title = "Convergence",
          .caption = fmt::format("First draw at {}; below 1 the objective prefers a wrong model.",
                                 grid.conditions[condition]),
          .panels = {std::move(panel)}};
}

}  // namespace modcal
