// Where Helmholtz motion ends on a Schelleng diagram.
#include <limits>
#include <utility>

#include "experiments/kinds/schelleng/schelleng_study.hpp"

namespace modcal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool is_helmholtz(const std::optional<CellOutcome>& outcome) {
  return outcome && outcome->failure.empty() && outcome->regime == StringRegime::kHelmholtz;
}

// First and one past the last row of the longest run of Helmholtz cells of a column.
std::pair<std::size_t, std::size_t> longest_run(const SchellengOptions& options,
                                                const CellOutcomes& outcomes, std::size_t column) {
  const auto columns = static_cast<std::size_t>(options.positions.count);
  const auto rows = static_cast<std::size_t>(options.forces.count);
  std::pair<std::size_t, std::size_t> best{0, 0};
  std::size_t begin = 0;
  for (std::size_t row = 0; row <= rows; ++row) {
    if (row < rows && is_helmholtz(outcomes[row * columns + column])) continue;
    if (row - begin > best.second - best.first) best = {begin, row};
    begin = row + 1;
  }
  return best;
}

}  // namespace

std::vector<BorderRatios> border_ratios(const SchellengOptions& options,
                                        const CellOutcomes& outcomes) {
  const std::vector<double> edges = options.forces.edges();
  std::vector<BorderRatios> ratios;
  for (std::size_t column = 0; column < static_cast<std::size_t>(options.positions.count);
       ++column) {
    const auto [begin, end] = longest_run(options, outcomes, column);
    const BowForceLimits limits = schelleng_limits(options.cell_scene(column));
    const bool is_there = begin < end;
    ratios.push_back({is_there && begin > 0 ? edges[begin] / limits.lowest : kNaN,
                      is_there && end + 1 < edges.size() ? edges[end] / limits.highest : kNaN});
  }
  return ratios;
}

}  // namespace modcal
