#pragma once

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// Normalized cumulative periodogram: the parameter whose residual is most like white noise,
/// minimum of the largest distance between the cumulative power of the residual's components and
/// that of white noise (Hansen, Kilmer and Kjeldsen, 2006, section 3). Components stand in the
/// order the problem gives them: the bins of a spectrum by frequency.
class CumulativePeriodogram final : public ParameterChoice {
 public:
  struct Options {
    CurveOptions curve = {};
    void visit(OptionVisitor& visitor);
  };
  explicit CumulativePeriodogram(const Options& options);

 private:
  Pick pick(const Regularizer& regularizer, const SpectralData& data,
            std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
