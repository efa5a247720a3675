// Many candidates of one modal frequency at once: the incremental form of F = R/H.
#pragma once

#include <span>
#include <vector>

#include "libsim/model/modal_model.hpp"

namespace modcal {

/// One sensor over the band of a mode; arrays padded to a multiple of kBinLanes.
struct ScannedSensor {
  const double* real = nullptr;  ///< of the sum without the mode
  const double* imag = nullptr;
  const double* magnitude = nullptr;  ///< |R|, 0 beyond the band
  double constant = 0.0;              ///< A of the mode
};

/// Integrals of |F_k| = |R_k|/|H_k| over a band while one pole moves, which changes H by one term:
/// with S_k, the sum of the others over the band, |F_k| is |R_k| |D| / |S_k D + A_k|. For models of
/// one contact with real constants and no residual terms, on the frequency axis. Blocks of bins are
/// spread over the cores and added up in their order; the bits do not depend on the number of
/// cores. Keeps its arrays from call to call: one per thread.
class ModeScan {
 public:
  /// integrals_j = Σ_bins Σ_k |R_k|/|H_k| with ω_n of mode n at candidates_j [rad/s]. `magnitudes`:
  /// |R_k| of every sensor of the model at all bins of the grid, empty where it was not recorded.
  void integrate(const ModalModel& model, std::size_t mode, const FrequencyGrid& grid,
                 const BinRange& bins, std::span<const std::vector<double>> magnitudes,
                 std::span<const double> candidates, std::span<double> integrals);

 private:
  SplitSpectra rest_;
  std::vector<std::vector<double>> magnitudes_;  // padded for the kernel
  std::vector<double> omegas_;
  std::vector<double> partial_;  // blocks × candidates
};

}  // namespace modcal
