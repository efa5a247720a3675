#include "libinverse/spectral/choices/robust_cross_validation.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

void RobustCrossValidation::Options::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visitor.number({.key = "gamma",
                  .meaning = "weight of plain cross validation; 1: nothing else",
                  .range = Range{0.0, 1.0, false, true}},
                 gamma);
}

RobustCrossValidation::RobustCrossValidation(const Options& options)
    : ParameterChoice(options.curve), gamma_(options.gamma) {
  MODCAL_REQUIRE(gamma_ > 0.0 && gamma_ <= 1.0, "gamma {:g} must lie in (0, 1]", gamma_);
}

ParameterChoice::Pick RobustCrossValidation::pick(const Regularizer& regularizer,
                                                  const SpectralData& data,
                                                  std::span<CurvePoint> curve) const {
  const double rows = static_cast<double>(data.problem->rows());
  const std::vector<double> sigma = penalized_sigma(regularizer, *data.problem);
  const std::span<const double> multiplicity = data.problem->multiplicity();
  std::vector<double> kept(sigma.size());
  for (CurvePoint& point : curve) {
    const double left = rows - point.freedom;
    if (!(left > 0.0)) continue;  // 0/0: every datum is fitted
    regularizer.filter_factors(sigma, point.parameter, kept);
    double square = 0.0;
    for (std::size_t i = 0; i < kept.size(); ++i) square += multiplicity[i] * kept[i] * kept[i];
    point.criterion = (gamma_ + (1.0 - gamma_) * square / rows) * point.residual_norm *
                      point.residual_norm / (left * left);
  }
  return smallest_criterion(curve, "robust cross validation");
}

}  // namespace modcal
