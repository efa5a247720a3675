#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// A parameter given by the user. The curve is traced beside it unless its number of points is 0.
class FixedParameter final : public ParameterChoice {
 public:
  struct Options {
    double value = std::numeric_limits<double>::quiet_NaN();  ///< parameter ≥ 0
    CurveOptions curve = {};
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for a value that is negative or not finite.
  explicit FixedParameter(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
  double value_;
};

}  // namespace modcal
