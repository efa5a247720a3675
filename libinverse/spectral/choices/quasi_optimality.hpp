#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Quasi-optimality: minimum of ‖dx/d log λ‖, from differences of the solutions at neighboring
/// parameters (Tikhonov and Glasko, 1965; Hansen, 1998, section 7.5), in the norm of the measure.
/// Needs no noise level. Neighbors with the same solution (a truncation that cuts nothing between
/// them) say nothing.
class QuasiOptimality final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    void visit(OptionVisitor& visitor);
  };
  explicit QuasiOptimality(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
