// The band of frequencies that a likelihood looks at.
#pragma once

#include "libcalib/parameters/parameter_table.hpp"

namespace modcal {

/// The band that N stated modes describe where further ones are in the model: up to half way from
/// mode N − 1 to mode N, less the 4 % by which a start may be too high [Hz]. What mode N + 1 leaves
/// ringing is no unknown of the fit, and one and a half spacings away it is small.
double band_of_modes(const ModalBasis& basis);

/// Highest ω of the likelihood's bins [rad/s]: highest_frequency [Hz], or where that is NaN
/// band_of_modes(), 1.05 times the highest mode where the model has no further ones; below 0.4 f_s.
/// Throws InvalidInput where fewer than two modes lie below a stated one.
double likelihood_band(const ModelPoint& point, double highest_frequency, double sample_rate);

}  // namespace modcal
