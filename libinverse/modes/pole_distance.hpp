// What the distance of two near poles, as far as a record tells it, leaves unknown of them.
#pragma once

#include "libinverse/modes/damped_sinusoid_fit.hpp"
#include "libinverse/modes/residual_search.hpp"

namespace modcal {

/// Deviations of poles nearer to each other than `reach` [Hz] hold what is not told of their
/// distance. Of two, λ and λ + Δ with the share s of the amplitude, a record tells the moments
/// about their mean: the second, Δ² s/(1 + s)², at first. Where the third is lost in noise they may
/// be any two of that moment, the larger one up to Δ√s/(1 + s) from the mean, and the bound by
/// slopes at one of them is far too small. So the fit is made again with every other distance,
/// outwards from that of the fit and, where χ² does not rise by kFarthestRise up to where both are
/// one, outwards from there in eight directions. A deviation is at least what its pole moves by
/// over the root of the rise of χ², or over 1 where that is less: the likelihood in place of its
/// curvature.
void widen_by_distance(DampedSinusoidFit& fit, double sample_rate, double reach,
                       double in_band_variance, const ResidualLevels& levels);

}  // namespace modcal
