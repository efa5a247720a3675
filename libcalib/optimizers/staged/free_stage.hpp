// The last stage of a continuation: every frequency free.
#pragma once

#include "libcalib/optimizers/staged/stroke_fit.hpp"

namespace modcal {

/// Where the stage starts.
struct FreeStart {
  const StringUnknowns& law;
  const Eigen::VectorXd& theta;  ///< of the law's unknowns
  /// χ² accepts the law: modes start from it. Else they come through damped records.
  bool from_law = true;
};

/// Frees every frequency under a prior about the law: wide first, each mode tested against its
/// neighboring minima; then as wide as the modes that follow the law scatter about it, wide open
/// for those that leave it. Fills what the result says of modes, contact, damping and sensors.
void free_frequencies(const AttemptInput& input, const FreeStart& start, StrokeFit& stroke,
                      ContinuationResult& result);

}  // namespace modcal
