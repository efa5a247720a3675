// Kernel of the joint likelihood with one mode moved and all else held.
#pragma once

#include <array>
#include <cstddef>

#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"

namespace modcal {

/// The bins about one mode, as they are without it.
struct ModeSurroundings {
  explicit ModeSurroundings(std::size_t bins);

  double sigma = 0.0;  ///< σ [1/s]; at σ = 0 the mode has an end state of its own
  std::array<double, 2> deviation{};
  PlanarVector left, right;            ///< h_1, h_2 less the mode
  PlanarVector left_data, right_data;  ///< Y_1, Y_2 with the mode's own decay left in
  AlignedVector left_noise, right_noise, mixed_noise;  ///< covariance of the noise
  PlanarVector sensor;                                 ///< of x = L, for one that reads 1 at x = 0
  PlanarVector delay;                                  ///< z^−1
  AlignedVector omega;                                 ///< [rad/s]
  AlignedVector weight;                                ///< √w; 0 beyond the bins in use
};

/// Σ w|e|² over the bins with the mode at its place and the best amplitude of its end state.
double cost_with(const ModeSurroundings& around, const LikelihoodMode& mode);

}  // namespace modcal
