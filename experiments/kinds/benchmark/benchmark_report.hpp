// What a benchmark shows: table, conclusion, figures.
#pragma once

#include <string>
#include <vector>

#include "experiments/kinds/benchmark/benchmark_summary.hpp"
#include "experiments/report/report.hpp"

namespace modcal {

/// One row a method and condition.
report::Table benchmark_table(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                              const std::string& command);
/// Heat map of the share of successes: one row a method, one column a condition.
report::Table success_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                          const std::string& command);
/// Heat map of the frequency RMSE over the Cramér–Rao bound; no rows where there is no bound.
report::Table bound_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                        const std::string& command);
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

}  // namespace modcal
