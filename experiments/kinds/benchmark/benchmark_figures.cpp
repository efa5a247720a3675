// Errors, cost and convergence of a benchmark.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/kinds/benchmark/benchmark_drawing.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

// Cells of a method with an estimate, by rising noise.
std::vector<const BenchmarkCell*> cells_of(const BenchmarkGrid& grid,
                                           const std::vector<BenchmarkCell>& cells,
                                           std::size_t method) {
  std::vector<const BenchmarkCell*> line;
  for (const BenchmarkCell& cell : cells) {
    if (cell.method == method && std::isfinite(cell.rms)) line.push_back(&cell);
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
    if (!std::isfinite(cell->bound)) continue;
    series.x.push_back(100.0 * grid.noise_levels[cell->condition]);
    series.y.push_back(cell->bound);
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
    series.x.push_back(static_cast<double>(evaluations));
    series.y.push_back(ratio > 0.0 ? ratio : std::numeric_limits<double>::quiet_NaN());
  }
  series.tasks.assign(series.x.size(), static_cast<std::int64_t>(task.task));
  return series;
}

}  // namespace

report::Figure error_figure(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells) {
  std::vector<report::Panel> panels =
      objective_panels(grid, {.label = "noise", .unit = "%"},
                       {.label = "relative rms error of f_n", .logarithmic = true},
                       [&](std::size_t method, report::Panel& panel) {
                         const auto line = cells_of(grid, cells, method);
                         if (panel.series.empty()) {
                           report::Series bound = bound_series(grid, line);
                           if (!bound.x.empty()) panel.series.push_back(std::move(bound));
                         }
                         report::Series series = method_series(grid, method, kAllConditions,
                                                               SeriesStyle::kLineWithPoints);
                         // Every noise level is in the line: no condition filters it.
                         if (grid.conditions.size() > 1) series.tags.pop_back();
                         for (const BenchmarkCell* cell : line) {
                           series.x.push_back(100.0 * grid.noise_levels[cell->condition]);
                           series.y.push_back(cell->rms);
                           series.y_low.push_back(cell->rms_q10);
                           series.y_high.push_back(cell->rms_q90);
                           series.tasks.push_back(cell->task);
                         }
                         if (!series.x.empty()) panel.series.push_back(std::move(series));
                       });
  return panel_figure(
      "error_against_noise", "Frequency error against noise",
      "Root mean square over the excited modes: median and band from 10 % to 90 % of the draws. "
      "The bound is that of both reactions with the force unknown: no unbiased estimate has a "
      "smaller error.",
      std::move(panels));
}

report::Figure work_precision_figure(const BenchmarkGrid& grid,
                                     const std::vector<BenchmarkCell>& cells) {
  std::vector<report::Panel> panels = objective_panels(
      grid, {.label = "time, median", .unit = "s", .logarithmic = true},
      {.label = "relative rms error of f_n", .logarithmic = true},
      [&](std::size_t method, report::Panel& panel) {
        for (const std::size_t condition : condition_choices(grid)) {
          report::Series series = method_series(grid, method, condition, SeriesStyle::kPoints);
          for (const BenchmarkCell* cell : cells_of(grid, cells, method)) {
            if (condition != kAllConditions && cell->condition != condition) continue;
            series.x.push_back(cell->seconds);
            series.y.push_back(cell->rms);
            series.tasks.push_back(cell->task);
          }
          if (!series.x.empty()) panel.series.push_back(std::move(series));
        }
      });
  return panel_figure("work_precision", "Error against time",
                      "One point a method and condition, medians over the draws.",
                      std::move(panels));
}

report::Figure trace_figure(const BenchmarkGrid& grid) {
  const std::size_t first = grid.conditions.size() / 2;
  std::vector<report::Panel> panels = objective_panels(
      grid, {.label = "evaluations", .logarithmic = true},
      {.label = "best value / value at the truth", .logarithmic = true},
      [&](std::size_t method, report::Panel& panel) {
        std::vector<bool> drawn(grid.conditions.size(), false);
        for (const BenchmarkTask& task : grid.tasks) {
          if (task.method != method || drawn[task.condition] || task.outcome.trace.empty()) {
            continue;
          }
          drawn[task.condition] = true;
          panel.series.push_back(trace_series(grid, task, task.condition == first));
        }
      });
  return panel_figure(
      "traces", "Convergence",
      fmt::format("One draw a method and condition, at first at {}; below 1 the objective prefers "
                  "a wrong model.",
                  grid.conditions[first]),
      std::move(panels));
}

}  // namespace modcal
