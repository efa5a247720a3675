#include "libcalib/problem/stop_reason.hpp"

#include <cassert>

namespace modcal {
namespace {

struct Words {
  std::string_view name;
  std::string_view sentence;
};

Words words_of(StopReason reason) {
  switch (reason) {
    case StopReason::kNotRun:
      return {"not_run", "Nothing has been searched."};
    case StopReason::kSearchCompleted:
      return {"search_completed", "The systematic search did all it was asked to."};
    case StopReason::kConverged:
      return {"converged", "The condition of an optimum holds within the tolerance."};
    case StopReason::kSmallStep:
      return {"small_step", "The variables change by less than the tolerance."};
    case StopReason::kSmallDecrease:
      return {"small_decrease", "The value falls by less than the tolerance."};
    case StopReason::kTargetReached:
      return {"target_reached", "The value is at or below the target."};
    case StopReason::kEvaluationBudget:
      return {"evaluation_budget", "The evaluations allowed are used up."};
    case StopReason::kTimeBudget:
      return {"time_budget", "The time allowed is used up."};
    case StopReason::kRoundoff:
      return {"roundoff", "Rounding errors keep the optimizer from progress."};
    case StopReason::kNotFinite:
      return {"not_finite",
              "The objective at the initial point or a step of the optimizer is not finite."};
    case StopReason::kNoProgress:
      return {"no_progress", "The optimizer gave up without reaching an optimum."};
  }
  assert(false);
  return {};
}

}  // namespace

std::string_view name_of(StopReason reason) { return words_of(reason).name; }
std::string_view explain(StopReason reason) { return words_of(reason).sentence; }

}  // namespace modcal
