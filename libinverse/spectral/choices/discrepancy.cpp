#include "libinverse/spectral/choices/discrepancy.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libinverse/spectral/problem/noise_level.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void Discrepancy::Options::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visitor.number({.key = "tau",
                  .meaning = "safety factor on the norm of the noise",
                  .unit = "1",
                  .range = Range::at_least(1.0)},
                 tau);
  visit_noise_rms(visitor, noise_rms);
}

Discrepancy::Discrepancy(const Options& options)
    : ParameterChoice(options.curve), tau_(options.tau), noise_rms_(options.noise_rms) {
  MODCAL_REQUIRE(tau_ >= 1.0 && std::isfinite(tau_), "tau {:g} must be a finite number >= 1", tau_);
  require_noise_option(noise_rms_);
}

ParameterChoice::Pick Discrepancy::pick(const Regularizer& /*regularizer*/,
                                        const SpectralData& data,
                                        std::span<CurvePoint> curve) const {
  const double rows = static_cast<double>(data.problem->rows());
  const double bound = tau_ * known_noise_rms(noise_rms_, data) * std::sqrt(rows);
  std::size_t within = 0;  // the residual rises with the parameter
  for (std::size_t j = 0; j < curve.size(); ++j) {
    if (bound > 0.0) curve[j].criterion = curve[j].residual_norm / bound;
    if (curve[j].residual_norm <= bound) within = j + 1;
  }
  if (within == 0) {
    return {curve.front().parameter, ChoiceStatus::kNotReached,
            fmt::format("the residual norm stays above {:.4g} down to the lowest parameter, which "
                        "stands in",
                        bound)};
  }
  if (within == curve.size()) {
    return {curve.back().parameter, ChoiceStatus::kEdgeOfRange,
            fmt::format("the residual norm {:.4g} at the upper edge of the searched range is still "
                        "within {:.4g}",
                        curve.back().residual_norm, bound)};
  }
  const CurvePoint& point = curve[within - 1];
  return {point.parameter, ChoiceStatus::kChosen,
          fmt::format("largest parameter whose residual norm {:.4g} is within {:.4g}",
                      point.residual_norm, bound)};
}

}  // namespace modcal
