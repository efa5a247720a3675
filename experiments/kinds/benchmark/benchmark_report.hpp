// What a benchmark shows: table, conclusion, figures.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/kinds/benchmark/benchmark_summary.hpp"
#include "experiments/report/report.hpp"

namespace modcal {

/// One row a method and condition.
report::Table benchmark_table(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// Heat map of the share of successes: one row a method, one column a condition.
report::Table success_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// Heat map of the frequency RMSE over the Cramér–Rao bound; no rows where there is no bound.
report::Table bound_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// The cell of a method under a condition; null: nothing of it is finished.
const BenchmarkCell* find_cell(const std::vector<BenchmarkCell>& cells, std::size_t method,
                               std::size_t condition);
/// Cells of one condition, best first; equals in the order of the methods.
std::vector<const BenchmarkCell*> ranked_cells(const std::vector<BenchmarkCell>& cells,
                                               std::size_t condition);
/// One sentence a condition: which methods to use; then which methods fail, where and why.
std::vector<std::string> conclusion(const BenchmarkGrid& grid,
                                    const std::vector<BenchmarkCell>& cells);

/// RMS frequency error against noise with the band from 10 % to 90 % of the draws and the
/// Cramér–Rao bound. Like the other figures: a panel an objective, tags for the page's filters, the
/// number of a task behind each point.
report::Figure error_figure(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// Share of tasks solved against evaluations spent (data profile: Moré and Wild, 2009, with success
/// judged on the truth).
report::Figure data_profile(const BenchmarkGrid& grid);
/// Share of problems solved within a factor of the evaluations of the fastest method (performance
/// profile: Dolan and Moré, 2002).
report::Figure performance_profile(const BenchmarkGrid& grid);
/// Median error against median time, one point a method and condition.
report::Figure work_precision_figure(const BenchmarkGrid& grid,
                                     const std::vector<BenchmarkCell>& cells);
/// Final errors of all draws in rising order (waterfall).
report::Figure waterfall_figure(const BenchmarkGrid& grid);
/// Best value so far above that at the truth, first draw of each condition.
report::Figure trace_figure(const BenchmarkGrid& grid);

// What the figures have in common: a panel an objective, a look a search, tags.

/// Index of no condition: a series over all of them.
inline constexpr std::size_t kAllConditions = static_cast<std::size_t>(-1);

/// Empty series of a method with its label, look and tags, for one condition or for all. That of
/// one condition is hidden until a filter asks for it.
report::Series method_series(const BenchmarkGrid& grid, std::size_t method, std::size_t condition,
                             report::SeriesStyle style);
report::Tags method_tags(const BenchmarkGrid& grid, std::size_t method);
/// Values of the tag "condition" of what belongs to one condition and is shown among all, too.
report::Tag condition_tag(const BenchmarkGrid& grid, std::size_t condition);

/// One panel an objective, with the series that `add` puts into it for each of its methods; panels
/// without any are left out.
std::vector<report::Panel> objective_panels(
    const BenchmarkGrid& grid, const report::Axis& x, const report::Axis& y,
    const std::function<void(std::size_t method, report::Panel& panel)>& add);

/// The figure with the panels side by side.
report::Figure panel_figure(report::Figure figure, std::vector<report::Panel> panels);

/// All conditions together, then, where there are several, each.
std::vector<std::size_t> condition_choices(const BenchmarkGrid& grid);

/// `count` indices of [0, size), evenly spread, first and last among them; all where they fit.
std::vector<std::size_t> spread_indices(std::size_t size, std::size_t count);

}  // namespace modcal
