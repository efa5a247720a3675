#include "libcalib/optimizers/mode_by_mode.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/optimizers/spaced_values.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

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
}

ModeByMode::ModeByMode(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.candidates >= 2, "{} candidates are no search: take at least 2",
                 options.candidates);
  MODCAL_REQUIRE(options.half_range > 0.0 && options.half_range < 1.0,
                 "half range {:g} must lie in (0, 1)", options.half_range);
  MODCAL_REQUIRE(options.loops >= 1, "{} loops: at least one is needed", options.loops);
}

CoordinateScan ModeByMode::search_variable(Evaluator& evaluator, std::size_t i,
                                           std::int64_t loop) const {
  const Variable& variable = evaluator.variables()[i];
  CoordinateScan scan{.variable = i, .loop = loop, .center = evaluator.position()[i]};
  const double reach = options_.half_range * std::abs(scan.center);
  scan.candidates.resize(static_cast<std::size_t>(options_.candidates));
  scan.values.resize(scan.candidates.size());
  space_evenly(std::max(variable.lower, scan.center - reach),
               std::min(variable.upper, scan.center + reach), scan.candidates);
  evaluator.scan(i, scan.candidates, scan.values);
  const auto best = std::min_element(scan.values.begin(), scan.values.end());
  scan.chosen = scan.candidates[static_cast<std::size_t>(best - scan.values.begin())];
  evaluator.move(i, scan.chosen);
  return scan;
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
  for (std::int64_t loop = 1; loop <= options_.loops; ++loop) {
    bool moved = false;
    std::vector<CoordinateScan> scans;
    for (std::size_t i = 0; i < n; ++i) {
      scans.push_back(search_variable(evaluator, i, loop));
      moved = moved || scans.back().chosen != scans.back().center;
    }
    if (kept.size() > n) kept.resize(n);
    kept.insert(kept.end(), std::make_move_iterator(scans.begin()),
                std::make_move_iterator(scans.end()));
    evaluator.count_loop();
    if (!moved) return StopReason::kConverged;
    if (loop < options_.loops) evaluator.refresh_scan();
  }
  return StopReason::kSearchCompleted;
}

}  // namespace modcal
