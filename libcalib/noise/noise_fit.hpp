// What the residual of a fit says of the noise of the sensors.
#pragma once

#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {

struct NoiseFit {
  NoiseSpectrum spectrum;  ///< over the record's s_r²; one knot or more
  /// More than noise is left.
  bool misfit = false;
};

/// Spectra and coherence under which what the model leaves of the record is likeliest,
///
///     min Σ_k ln v_k + |z_k|²/v_k,   z = h_2y_1 − h_1y_2,
///     v = C₂₂|h_1|² + C₁₁|h_2|² − 2 C₁₂ Re conj(h_1) h_2.
///
/// Bins about modes and lines are left out. Of two levels, these with a coherence, spectra with a
/// knot for each octave, these with a coherence for each knot, that with the least −2 ln L + p ln K
/// (Schwarz, 1978). What a wrong model leaves is no noise: it grows with the signal, or fills a few
/// neighboring bins. Both is tested for, and where it is found two levels are fitted to the third
/// of the bins that has least signal; of too few bins the levels stay. For a likelihood without
/// weights.
NoiseFit fit_noise(const ProjectedLikelihood& likelihood, const ModelPoint& point);

}  // namespace modcal
