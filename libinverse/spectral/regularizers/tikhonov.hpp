#pragma once

#include <cstdint>

#include "libinverse/spectral/regularizers/regularizer.hpp"

namespace modcal {

/// Tikhonov regularization of order p: minimum of ‖b − A x‖² + λ² ‖D^p x‖², φ = σ²/(σ² + λ²
/// (ω/ω̄)^2p) (Hansen, 1998, section 5.1), ω̄ the rms angular frequency of the problem. The parameter
/// is λ, in the unit of the singular values [N/N].
class Tikhonov final : public Regularizer {
 public:
  struct Options {
    std::int64_t order = 0;  ///< p: 0, 1 or 2
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for another order.
  explicit Tikhonov(const Options& options);
  bool has_penalty() const override { return order_ > 0; }
  double penalty(double omega, double reference) const override;

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
  /// One pass over a compacted problem per parameter.
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const override;
  std::int64_t order_;
};

/// φ = σ²/(σ² + λ²) without cancellation; lost = 1 − φ.
void tikhonov_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                      std::span<double> lost);

}  // namespace modcal
