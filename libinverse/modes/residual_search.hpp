// What a fit of damped sinusoids has left in its residual: noise, and poles that it lacks.
#pragma once

#include <cstddef>
#include <vector>

#include "libinverse/modes/damped_sinusoid_fit.hpp"

namespace modcal {

/// Density of the noise over frequency, relative to white noise of the residual's variance within
/// the band: the median over 64 bins to either side of the power of the residual's second
/// half, where decays have gone, and at least 1, times the record's rounding.
class ResidualLevels {
 public:
  ResidualLevels(const DecayRecord& record, const DampedSinusoidFit& fit, double in_band_variance);

  double at(std::size_t channel, double frequency) const;
  /// That of the channel in which it is largest.
  double largest(double frequency) const;

 private:
  double spacing_;  // of the levels [Hz]
  std::vector<std::vector<double>> levels_;
};

/// Poles, the loudest first, at which one more damped sinusoid would lower χ² by more than `least`:
/// Σ_c |Σ_m r_c(t_m) exp(−(d + iν)t_m)|²/(½ v_c ℓ_c(ν) Σ_m exp(−2dt_m)) over the channels'
/// residuals r_c, the variances v_c of their noise and its levels ℓ_c, on a grid of half bins of ν
/// and octaves of d from 1/T to π/10 times the sample rate. It is what χ² falls by where no pole of
/// the fit is near, and less beside one. Of those nearer to each other than their widths, (d +
/// 2π/T)/2π [Hz], the loudest. Empty where the residual is noise.
std::vector<DecayPole> poles_in_residual(const DampedSinusoidFit& fit, const ResidualLevels& levels,
                                         double sample_rate, double in_band_variance, double least);

}  // namespace modcal
