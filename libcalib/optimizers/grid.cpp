#include "libcalib/optimizers/grid.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/optimizers/spaced_values.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void Grid::Options::visit(OptionVisitor& visitor) {
  visitor.integer({.key = "points",
                   .meaning = "grid points per variable, bounds included",
                   .range = Range::closed(2, 1000000)},
                  points);
}

Grid::Grid(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.points >= 2, "a grid of {} points per variable has no extent: take >= 2",
                 options.points);
}

void Grid::require_feasible(const Evaluator& evaluator) const {
  const double total =
      std::pow(static_cast<double>(options_.points), static_cast<double>(evaluator.dimension()));
  MODCAL_REQUIRE(total < static_cast<double>(evaluator.evaluations_left()),
                 "a grid of {} points in each of {} variables has {:.3g} points, the budget allows "
                 "{} evaluations with that of the initial point: free fewer parameters, take fewer "
                 "points, or another optimizer",
                 options_.points, evaluator.dimension(), total, evaluator.evaluations_left());
}

StopReason Grid::search(Evaluator& evaluator) const {
  if (evaluator.dimension() == 1) {
    search_line(evaluator);
  } else {
    search_box(evaluator);
  }
  return StopReason::kSearchCompleted;
}

void Grid::search_line(Evaluator& evaluator) const {
  const Variable& variable = evaluator.variables()[0];
  CoordinateScan scan{.loop = 1, .center = variable.initial};
  scan.candidates.resize(static_cast<std::size_t>(options_.points));
  space_evenly(variable.lower, variable.upper, scan.candidates);
  for (const double x : scan.candidates) {
    const double z = (x - variable.initial) / variable.scale;
    scan.values.push_back(evaluator.value(std::span(&z, 1)));
  }
  const auto best = std::min_element(scan.values.begin(), scan.values.end());
  scan.chosen = scan.candidates[static_cast<std::size_t>(best - scan.values.begin())];
  evaluator.record(std::move(scan));
}

void Grid::search_box(Evaluator& evaluator) const {
  const std::size_t n = evaluator.dimension();
  std::vector<std::vector<double>> axes(n);
  std::vector<double> z(n);
  for (std::size_t i = 0; i < n; ++i) {
    axes[i].resize(static_cast<std::size_t>(options_.points));
    space_evenly(evaluator.lower()[i], evaluator.upper()[i], axes[i]);
    z[i] = axes[i][0];
  }
  std::vector<std::size_t> index(n, 0);
  for (std::size_t axis = 0; axis < n;) {
    evaluator.value(z);
    // The next point in the manner of an odometer.
    for (axis = 0; axis < n; ++axis) {
      index[axis] = (index[axis] + 1) % axes[axis].size();
      z[axis] = axes[axis][index[axis]];
      if (index[axis] != 0) break;
    }
  }
}

}  // namespace modcal
