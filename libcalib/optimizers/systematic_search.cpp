#include "libcalib/optimizers/systematic_search.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// values_j from low to high in equal steps, both ends exact; at least two values.
void space_evenly(double low, double high, std::span<double> values) {
  const auto last = static_cast<double>(values.size() - 1);
  for (std::size_t j = 0; j < values.size(); ++j) {
    values[j] = std::lerp(low, high, static_cast<double>(j) / last);
  }
}

double& nearest_of(std::vector<double>& candidates, double value) {
  return *std::min_element(candidates.begin(), candidates.end(), [value](double a, double b) {
    return std::abs(a - value) < std::abs(b - value);
  });
}

}  // namespace

void ModeByMode::Options::visit(OptionVisitor& visitor) {
  visitor("candidates", "candidates per variable and loop", {.range = Range::closed(2, 1000000)},
          candidates);
  visitor("half_range", "how far candidates reach to either side, relative to the variable",
          {.range = Range::open(0.0, 1.0)}, half_range);
  visitor("loops", "how often all variables are searched", {.range = Range::closed(1, 1000000)},
          loops);
  visitor("skip_settled",
          "leave out searches whose answer no longer changes, save in the last "
          "loop",
          skip_settled);
}

ModeByMode::ModeByMode(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.candidates >= 2, "{} candidates are no search: take at least 2",
                 options.candidates);
  MODCAL_REQUIRE(options.half_range > 0.0 && options.half_range < 1.0,
                 "half range {:g} must lie in (0, 1)", options.half_range);
  MODCAL_REQUIRE(options.loops >= 1, "{} loops: at least one is needed", options.loops);
}

void ModeByMode::place_candidates(const Variable& variable, double center, std::int64_t count,
                                  std::vector<double>& candidates) const {
  const double reach = options_.half_range * std::abs(center);
  candidates.resize(static_cast<std::size_t>(count));
  space_evenly(std::max(variable.lower, center - reach), std::min(variable.upper, center + reach),
               candidates);
}

CoordinateScan ModeByMode::search_variable(Evaluator& evaluator, std::size_t i, std::int64_t loop,
                                           SettledVariables& settled) const {
  CoordinateScan scan{.variable = i, .loop = loop, .center = evaluator.position()[i]};
  const std::int64_t left = evaluator.evaluations_left();
  // A lone candidate compares with nothing: scan() ends the search.
  const std::int64_t count = left < 2 ? options_.candidates : std::min(options_.candidates, left);
  place_candidates(evaluator.variables()[i], scan.center, count, scan.candidates);
  scan.values.resize(scan.candidates.size());
  // Fewer candidates may all be worse than the current value, which then stays.
  if (count < options_.candidates) nearest_of(scan.candidates, scan.center) = scan.center;
  evaluator.scan(i, scan.candidates, scan.values);
  const auto best = std::min_element(scan.values.begin(), scan.values.end());
  const auto place = static_cast<std::size_t>(best - scan.values.begin());
  scan.chosen = std::isfinite(*best) ? scan.candidates[place] : scan.center;
  const double step = scan.candidates[1] - scan.candidates[0];
  settled.searched(i, evaluator.position(), {.place = place, .step = step}, scan.chosen);
  evaluator.move(i, scan.chosen);
  return scan;
}

// Variable i goes where a search is expected to put it.
void ModeByMode::leave_out(Evaluator& evaluator, std::size_t i, SettledVariables& settled) const {
  std::vector<double> candidates;
  place_candidates(evaluator.variables()[i], evaluator.position()[i], options_.candidates,
                   candidates);
  const double expected = candidates[settled.expected_place(i)];
  settled.left_out(i, expected);
  evaluator.move(i, expected);
}

void ModeByMode::require_feasible(const Evaluator& evaluator) const {
  for (const Variable& variable : evaluator.variables()) {
    MODCAL_REQUIRE(
        variable.initial != 0.0,
        "\"{}\" starts at 0, so a range relative to it is empty: give it another initial "
        "value or take another optimizer",
        variable.name);
  }
}

StopReason ModeByMode::search(Evaluator& evaluator) const {
  evaluator.open_scan();
  const std::size_t n = evaluator.dimension();
  std::vector<CoordinateScan>& kept = evaluator.recorded_scans();
  SettledVariables settled(evaluator.position());
  bool every = false;  // nothing moved in the loop before, which left some out
  for (std::int64_t loop = 1; loop <= options_.loops; ++loop) {
    every = every || !options_.skip_settled || loop == options_.loops;
    bool moved = false;
    std::vector<CoordinateScan> scans;
    for (std::size_t i = 0; i < n; ++i) {
      const double before = evaluator.position()[i];
      const auto reaches = [&](std::size_t j) { return evaluator.reaches(j, i); };
      if (!every && settled.is_settled(i, evaluator.position(), reaches)) {
        leave_out(evaluator, i, settled);
      } else {
        scans.push_back(search_variable(evaluator, i, loop, settled));
      }
      moved = moved || evaluator.position()[i] != before;
    }
    const std::size_t searched = scans.size();
    if (kept.size() > n) kept.resize(n);
    kept.insert(kept.end(), std::make_move_iterator(scans.begin()),
                std::make_move_iterator(scans.end()));
    evaluator.count_loop(searched);
    if (!moved && searched == n) return StopReason::kConverged;
    every = !moved;
    if (loop < options_.loops) evaluator.refresh_scan();
  }
  return StopReason::kSearchCompleted;
}

void Grid::Options::visit(OptionVisitor& visitor) {
  visitor("points", "grid points per variable, bounds included",
          {.range = Range::closed(2, 1000000)}, points);
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
