#include "libcalib/optimizers/mode_by_mode.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/optimizers/spaced_values.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

double& nearest_of(std::vector<double>& candidates, double value) {
  return *std::min_element(candidates.begin(), candidates.end(), [value](double a, double b) {
    return std::abs(a - value) < std::abs(b - value);
  });
}

}  // namespace

void ModeByMode::Options::visit(OptionVisitor& visitor) {
  visitor.integer({.key = "candidates",
                   .meaning = "candidates per variable and loop",
                   .range = Range::closed(2, 1000000)},
                  candidates);
  visitor.number({.key = "half_range",
                  .meaning = "how far candidates reach to either side, relative to the variable",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 half_range);
  visitor.integer({.key = "loops",
                   .meaning = "how often all variables are searched",
                   .range = Range::closed(1, 1000000)},
                  loops);
  visitor.flag({.key = "skip_settled",
                .meaning = "leave out searches whose answer no longer changes, save in the last "
                           "loop"},
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

}  // namespace modcal
