// Attempts at one record with its noise, the causes of its misfit and the lines of the mains.
#pragma once

#include "libcalib/optimizers/staged/continuation_attempt.hpp"

namespace modcal {

/// attempt_continuation() from the noise as it was read, again with the noise that the fit leaves,
/// with the first cause that its tests name, a bridge that moves taken out of the record, and,
/// where it is not right, with the lines of the mains that it shows. shown: lines were taken from a
/// fit already, and no other start shows further ones.
ContinuationResult attempt_with_causes(const AttemptInput& input, double shift,
                                       std::size_t evaluations, bool& shown);

}  // namespace modcal
