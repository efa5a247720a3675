#pragma once

#include "libinverse/spectral/regularizers/regularizer.hpp"

namespace modcal {

/// Wiener filter for white noise and a force that jumps, φ = |H|² P/(|H|² P + λ²) with
/// P = 1/(1 + (ω/ω_c)²) (Wiener, 1949): λ² is the variance of the noise over that of the force
/// below the corner ω_c. The parameter is λ, in the unit of the singular values [N/N].
class WienerFilter final : public Regularizer {
 public:
  struct Options {
    double corner = 50.0;  ///< ω_c/2π [Hz]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for a corner that is not > 0.
  explicit WienerFilter(const Options& options);
  bool has_penalty() const override { return true; }
  double penalty(double omega, double reference) const override;

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const override;
  double corner_;  // [rad/s]
};

}  // namespace modcal
