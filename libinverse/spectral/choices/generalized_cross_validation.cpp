#include "libinverse/spectral/choices/generalized_cross_validation.hpp"

namespace modcal {

ParameterChoice::Pick GeneralizedCrossValidation::pick(const Regularizer& /*regularizer*/,
                                                       const SpectralData& data,
                                                       std::span<CurvePoint> curve) const {
  const double rows = static_cast<double>(data.problem->rows());
  for (CurvePoint& point : curve) {
    const double left = rows - point.freedom;
    // With every datum fitted the quotient is 0/0 and says nothing.
    if (left > 0.0) point.criterion = point.residual_norm * point.residual_norm / (left * left);
  }
  return smallest_criterion(curve, "generalized cross validation");
}

}  // namespace modcal
