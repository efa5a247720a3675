#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Discrepancy principle: the largest parameter with ‖r‖ ≤ τ s √m, s the standard deviation of the
/// noise and m the number of data (Morozov, 1966). The criterion is ‖r‖ over that bound.
class Discrepancy final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    double tau = 1.0;  ///< τ ≥ 1 [1]
    /// s, in the unit of the data; NaN: as the data state it.
    double noise_rms = std::numeric_limits<double>::quiet_NaN();
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for τ < 1.
  explicit Discrepancy(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
  double tau_;
  double noise_rms_;
};

}  // namespace modcal
