// The last stage of a continuation: every frequency free.
#pragma once

#include "libcalib/optimizers/staged/stroke_fit.hpp"

namespace modcal {

/// The law where all of the record has it, and where the last damped one has.
struct FreeStarts {
  const StringUnknowns& law;
  const Eigen::VectorXd& of_record;  ///< of the law's unknowns
  const Eigen::VectorXd& of_ladder;
};

/// Frees every frequency under a prior about the law: wide first, each mode tested against its
/// neighboring minima; then as wide as the modes that follow the law scatter about it, wide open
/// for those that leave it. Starts at the law where χ² accepts it or nearly does; where it does not
/// and what comes of that start is no better, through damped records, which have wider basins.
/// Fills what the result, which has the law's, says of modes, contact, damping and sensors.
void free_frequencies(const AttemptInput& input, const FreeStarts& starts, StrokeFit& stroke,
                      ContinuationResult& result);

}  // namespace modcal
