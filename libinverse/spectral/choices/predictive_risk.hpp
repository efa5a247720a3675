#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Unbiased predictive risk estimate: minimum of ‖r‖² + 2 s² Σ φ − m s², s the standard deviation
/// of the noise and m the number of data (Vogel, 2002, section 7.1). Supposes white noise of known
/// level.
class PredictiveRisk final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    /// s, in the unit of the data; NaN: as the data state it.
    double noise_rms = std::numeric_limits<double>::quiet_NaN();
    void visit(OptionVisitor& visitor);
  };
  explicit PredictiveRisk(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
  double noise_rms_;
};

}  // namespace modcal
