// Why a search ended.
#pragma once

#include <string_view>

namespace modcal {

enum class StopReason {
  kNotRun,            ///< nothing has been searched yet
  kSearchCompleted,   ///< the systematic search did all it was asked to
  kConverged,         ///< the back end's optimality condition holds
  kSmallStep,         ///< the variables no longer change
  kSmallDecrease,     ///< the value no longer falls
  kTargetReached,     ///< the value is at or below the target
  kEvaluationBudget,  ///< no evaluation is left
  kTimeBudget,        ///< the time is used up
  kRoundoff,          ///< rounding errors keep the back end from progress
  kNotFinite,         ///< the objective at the start or a step is not finite
  kNoProgress,        ///< the back end gave up without an optimum
};

/// Word for results and files: "search_completed", …
std::string_view name_of(StopReason reason);
/// One sentence for reports.
std::string_view explain(StopReason reason);

}  // namespace modcal
