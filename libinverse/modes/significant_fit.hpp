// A fit of damped sinusoids without those that are noise.
#pragma once

#include <vector>

#include "libinverse/modes/damped_sinusoid_fit.hpp"

namespace modcal {

/// What χ² of `degrees` of freedom does not reach at any of so many places with a probability of
/// 99.9 %.
double largest_by_chance(std::size_t places, std::size_t degrees);

/// fit_damped_sinusoids() without poles that are noise, of which there may be one at as many places
/// as there are samples. Left out are, and the rest is fitted again: all whose evidence is not
/// beyond chance; and one by one those next to a larger one, by less than `reach` [Hz], without
/// which χ² rises by no more. A pole of noise follows the noise to where the fit is best, so that
/// its deviations are too small; it may keep the fit from converging, and shares a mode with its
/// neighbor. No modes where none is left.
DampedSinusoidFit fit_significant(const DecayRecord& record, std::vector<DecayPole> start,
                                  double reach, const DampedSinusoidOptions& options);

}  // namespace modcal
