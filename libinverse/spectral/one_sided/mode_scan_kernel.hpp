// Kernel of the scan of one modal frequency: no allocation, instruction set chosen at run time.
#pragma once

#include <cstddef>
#include <span>

namespace modcal {

/// One sensor over the band of a mode; arrays padded to a multiple of kBinLanes.
struct ScannedSensor {
  const double* real = nullptr;  ///< of the sum without the mode
  const double* imag = nullptr;
  const double* magnitude = nullptr;  ///< |R|, 0 beyond the band
  double constant = 0.0;              ///< A of the mode
};

/// integrals_j += Σ_k Σ_sensors |R| |D| / |rest D + A| with D at ω_n = candidates_j [rad/s], for
/// one sensor or two. Floor with both: a division, a square root and an inverse root per bin and
/// candidate.
void integrate_candidates(std::span<const ScannedSensor> sensors, std::span<const double> omegas,
                          double zeta, std::span<const double> candidates,
                          std::span<double> integrals);

}  // namespace modcal
