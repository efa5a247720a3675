#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Robust generalized cross validation: minimum of [γ + (1 − γ) μ] ‖r‖²/(m − Σ φ)², μ = Σ φ²/m
/// (Lukas, 2006, eq. 1.6): too little regularization costs more than in generalized cross
/// validation.
class RobustCrossValidation final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    double gamma = 0.3;  ///< γ in (0, 1]; 1: generalized cross validation
    void visit(OptionVisitor& visitor);
  };
  explicit RobustCrossValidation(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
  double gamma_;
};

}  // namespace modcal
