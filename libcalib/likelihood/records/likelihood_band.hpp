// The band of frequencies that a likelihood looks at.
#pragma once

#include "libcalib/parameters/parameter_table.hpp"

namespace modcal {

/// The band that N stated modes describe where further ones are in the model: up to half way from
/// mode N − 1 to mode N, less the 4 % by which a start may be too high [Hz]. What mode N + 1 leaves
/// ringing is no unknown of the fit, and one and a half spacings away it is small.
double band_of_modes(const ModalBasis& basis);

/// How many of the stated modes, the first, ring in a band up to `highest` [Hz] or so near it that
/// what they leave ringing is not smooth there: all in band_of_modes() and above. The decays of
/// others are no unknowns of their own: powers of s hold them, and dozens of columns that hardly
/// differ in the band would take amplitudes that noise decides.
std::size_t ringing_modes(const ModalBasis& basis, double highest);

/// Highest ω of the likelihood's bins [rad/s]: highest_frequency [Hz], or where that is NaN
/// band_of_modes(), 1.05 times the highest mode where the model has no further ones; below 0.4 f_s.
/// Throws InvalidInput where fewer than two modes lie below a stated one.
double likelihood_band(const ModelPoint& point, double highest_frequency, double sample_rate);

}  // namespace modcal
