#include "libinverse/spectral/choices/predictive_risk.hpp"

#include "libinverse/spectral/problem/noise_level.hpp"

namespace modcal {

void PredictiveRisk::Options::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visit_noise_rms(visitor, noise_rms);
}

PredictiveRisk::PredictiveRisk(const Options& options)
    : ParameterChoice(options.curve), noise_rms_(options.noise_rms) {
  require_noise_option(noise_rms_);
}

ParameterChoice::Pick PredictiveRisk::pick(const Regularizer& /*regularizer*/,
                                           const SpectralData& data,
                                           std::span<CurvePoint> curve) const {
  const double noise = known_noise_rms(noise_rms_, data);
  const double rows = static_cast<double>(data.problem->rows());
  for (CurvePoint& point : curve) {
    point.criterion =
        point.residual_norm * point.residual_norm + (2.0 * point.freedom - rows) * noise * noise;
  }
  return smallest_criterion(curve, "predictive risk");
}

}  // namespace modcal
