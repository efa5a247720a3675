// What the residual of a fit says of the noise of the sensors.
#pragma once

#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {

struct NoiseFit {
  NoiseSpectrum spectrum;  ///< over the record's s_r²; one knot or more, none with a misfit
  bool misfit = false;     ///< more than noise is left
  double level = 1.0;      ///< with a misfit: power of the noise over that taken for it
  double error = 0.0;      ///< relative standard deviation of the power
};

/// Spectra and coherence under which what the model leaves of the record is likeliest,
///
///     min Σ_k ln v_k + |z_k|²/v_k,   z = h_2y_1 − h_1y_2,
///     v = C₂₂|h_1|² + C₁₁|h_2|² − 2 C₁₂ Re conj(h_1) h_2.
///
/// Bins about modes and lines are left out. Of two levels, these with a coherence, spectra with a
/// knot for each octave, these with a coherence for each knot, that with the least −2 ln L + p ln K
/// (Schwarz, 1978). What a wrong model leaves is no noise: it grows
/// with the signal, or fills a few neighboring bins. Both is tested for, and where it is found the
/// level is that of the third of the bins that has least signal; of too few bins it stays. For the
/// likelihood of a whole record (σ = 0) without weights.
NoiseFit fit_noise(const ProjectedLikelihood& likelihood, const ModelPoint& point);

}  // namespace modcal
