// What Ceres' solvers have in common for their back ends.
#pragma once

#include <ceres/types.h>
#include <glog/logging.h>

#include "libcalib/problem/stop_reason.hpp"

namespace modcal {

/// Ceres' solvers write warnings to standard error (restarts of conjugate gradients, rounding) that
/// the stop reason tells better: switched off for the whole process at the first use.
inline void silence_ceres() {
  static const bool once = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;
    return true;
  }();
  static_cast<void>(once);
}

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
