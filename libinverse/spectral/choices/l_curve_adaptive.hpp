#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// L-curve by adaptive pruning: corners of the discrete curve (log ‖r‖, log ‖x‖) are sought on its
/// longest 5, 10, 20, … segments, by the sharpest turn and by the point nearest to where the flat
/// and the steep part would meet; the corner is the candidate with most regularization from which
/// the next one costs more in log ‖x‖ than it gains in log ‖r‖ (Hansen, Jensen and Rodriguez, 2007,
/// sections 3 and 4). Needs no smoothness: small clusters and staircases do not draw it away. The
/// criterion is the distance of a point from the corner in decades.
class LCurveAdaptive final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    void visit(OptionVisitor& visitor) { curve.visit(visitor); }
  };
  explicit LCurveAdaptive(const Options& options) : ParameterChoice(options.curve, 5) {}

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
