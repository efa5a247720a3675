#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Generalized cross validation: minimum of ‖r‖²/(m − Σ φ)², m the number of data (Golub, Heath and
/// Wahba, 1979, eq. 1.4). Needs no noise level; supposes white noise.
class GeneralizedCrossValidation final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    void visit(OptionVisitor& visitor) { curve.visit(visitor); }
  };
  explicit GeneralizedCrossValidation(const Options& options) : ParameterChoice(options.curve) {}

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
