// Whether a decay is long enough to be identified, before there is one.
#pragma once

#include <cstddef>

#include "libinverse/modes/pluck_identification.hpp"

namespace modcal {

/// Throws InvalidInput, as identify_pluck() would, where `samples` at `sample_rate` [Hz] leave
/// nothing behind the time skipped, are too few for the filter of the band, or for the block rows
/// of the Hankel matrix after it.
void require_decay_length(std::size_t samples, double sample_rate, const PluckOptions& options);

}  // namespace modcal
