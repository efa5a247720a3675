#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// L-curve: the parameter of largest curvature of (log ‖r‖, log ‖x‖) (Hansen and O'Leary, 1993, eq.
/// 3.6), from central differences in log λ. The curve of a water level is a staircase, so that
/// differences are taken over a span of parameters and not between neighbors.
class LCurve final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    double span = 0.1;  ///< half span of the differences [decades]; 0: neighboring points
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for a span that is negative or not finite.
  explicit LCurve(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
  double span_;
};

}  // namespace modcal
