#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Bayesian evidence: maximum of the marginal likelihood of the data for Gaussian noise of unknown
/// level and a Gaussian solution whose prior makes φ the posterior mean, criterion
/// m log(Σ (1 − φ) |u_iᵀb|²) − Σ log(1 − φ) (MacKay, 1992, section 3, the level eliminated), m the
/// number of data. A component that a filter keeps whole (φ = 1) has the prior that is worth one
/// datum, 1 − φ = 1/(1 + m) (Kass and Wasserman, 1995).
class Evidence final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    void visit(OptionVisitor& visitor);
  };
  explicit Evidence(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
