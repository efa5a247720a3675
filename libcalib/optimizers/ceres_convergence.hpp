// What Ceres' solvers have in common for their back ends.
#pragma once

#include <ceres/types.h>

#include "libcalib/stop_reason.hpp"

namespace modcal {

/// Why a solver that did not fail has ended: Ceres tells its three kinds of convergence apart in
/// its message only.
template <typename Summary>
StopReason convergence_reason(const Summary& summary) {
  if (summary.termination_type != ceres::CONVERGENCE) return StopReason::kNoProgress;
  if (summary.message.starts_with("Function tolerance")) return StopReason::kSmallDecrease;
  if (summary.message.starts_with("Parameter tolerance")) return StopReason::kSmallStep;
  return StopReason::kConverged;
}

}  // namespace modcal
