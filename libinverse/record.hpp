// Reactions as estimators take them.
#pragma once

#include <array>
#include <limits>
#include <span>

#include "libsim/model.hpp"

namespace modcal {

/// The two reactions of one record, by End; an empty span: not recorded.
using ReactionPair = std::array<std::span<const double>, 2>;

/// The sensors of the reactions, by End; of their numbers estimators use gain and delay.
using SensorPair = std::array<Sensor, 2>;

/// One record as an estimator sees it. Spans are empty where a signal is not known.
struct EstimationRecord {
  ReactionPair reactions;  ///< by End, K samples each [N]
  /// Standard deviations of the noise of one sample as stated by a simulated measurement [N]; NaN:
  /// not known. Only rules that ask for a known noise level may use them.
  std::array<double, 2> stated_noise = {std::numeric_limits<double>::quiet_NaN(),
                                        std::numeric_limits<double>::quiet_NaN()};
  /// True force [N]: for limits that nobody can beat, never for an estimate.
  std::span<const double> true_force;
};

}  // namespace modcal
