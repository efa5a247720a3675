#pragma once

#include "libinverse/regularizer.hpp"

namespace modcal {

/// Tikhonov regularization of order 0: minimum of ‖b − A x‖² + λ² ‖x‖², φ = σ²/(σ² + λ²) (Hansen,
/// 1998, section 5.1). The parameter is λ, in the unit of the singular values [N/N].
class Tikhonov final : public Regularizer {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit Tikhonov(const Options& /*options*/) {}

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
  /// One pass over a compacted problem per parameter.
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
