// Lines of the mains in the bins of a record.
#pragma once

#include <array>
#include <cstddef>

#include "libsim/base/aligned_vector.hpp"

namespace modcal {

/// Cosine and sine, steady and growing over the record: the frequency of the mains is known and
/// steady but to a fraction of 1/T.
using LineWaves = std::array<PlanarVector, 4>;

/// The bins of a record of n samples, damped by exp(−σt).
struct WaveBins {
  double sigma = 0.0;         ///< σ [1/s]
  double sample_rate = 0.0;   ///< f_s [Hz]
  double samples = 0.0;       ///< n
  std::size_t count = 0;      ///< of `delay`; what is behind them is left 0
  const PlanarVector& delay;  ///< z^−1 = exp(−s_k/f_s)
};

/// Transforms of a line at `omega` [rad/s] over √n.
LineWaves line_waves(double omega, const WaveBins& bins);

}  // namespace modcal
