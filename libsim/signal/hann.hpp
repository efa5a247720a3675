// Spectrum in which neither lines nor the ends of a record hide what is between them.
#pragma once

#include <span>
#include <vector>

#include "libsim/signal/fft.hpp"

namespace modcal {

/// Σ_j w_j (x_j − x̄) exp(−2πi jk/K)/√(Σ w²) under the Hann window w_j = ½ − ½ cos(2πj/K) in the
/// unit of the samples: white noise of variance σ² has E|X_k|² = σ². K ≥ 2 samples; K/2 + 1 bins.
std::vector<Complex> hann_spectrum(std::span<const double> samples);

}  // namespace modcal
