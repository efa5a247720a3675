#pragma once

#include "libcalib/objective.hpp"

namespace modcal {

/// Smooth variant of spectral_peak: |F_r| is replaced by √(|F_r|² + δ²), which has slopes where
/// |F_r| vanishes, and the sum is one of squares, r = √(2 c_k) (|F_r(ω_k)|² + δ²)^¼ with c_k the
/// number of bands that hold the bin, value ½ ‖r‖² [N]. δ is `softening` times the mean |F_r| of
/// the initial parameters over both reactions; for δ → 0 the value is that of spectral_peak, and it
/// never lies more than δ Σ c_k above it.
class SmoothSpectralPeak final : public Objective {
 public:
  struct Options {
    double half_band = 0.04;  ///< relative to f*_n [1]
    double softening = 0.01;  ///< δ relative to the mean |F| [1]
    void visit(OptionVisitor& visitor);
  };
  explicit SmoothSpectralPeak(const Options& options);

 private:
  /// Throws InvalidInput where a band holds no bin.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
