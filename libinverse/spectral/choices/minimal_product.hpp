#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Minimal product: interior local minimum over ε of ‖R − H F_ε‖·‖dF_ε/dt‖ (Debut, Delaune and
/// Antunes, 2010, section 5; with the measure "solution": ‖R − H F_ε‖·‖F_ε‖). The product falls to
/// 0 when everything is cut off, so that end is no answer. The curve of a water level is a fine
/// sawtooth with dozens of local minima: the most prominent one on the logarithmic grid is meant,
/// the one whose basin takes the highest climb to leave.
/// Without an interior minimum the status says so and the lowest parameter stands in.
class MinimalProduct final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    void visit(OptionVisitor& visitor) { curve.visit(visitor); }
  };
  explicit MinimalProduct(const Options& options) : ParameterChoice(options.curve) {}

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
