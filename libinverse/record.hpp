// Reactions as estimators take them.
#pragma once

#include <array>
#include <limits>
#include <span>

namespace modcal {

class OptionVisitor;

/// The two reactions of one record, by End; an empty span: not recorded.
using ReactionPair = std::array<std::span<const double>, 2>;

/// How the two sensors read: R_measured(t) = gain · R(t − delay).
struct SensorOptions {
  double gain[2] = {1.0, 1.0};   ///< [1]
  double delay[2] = {0.0, 0.0};  ///< [s]

  bool alike() const { return gain[0] == gain[1] && delay[0] == delay[1]; }
  void visit(OptionVisitor& visitor);
};

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
