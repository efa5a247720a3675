#include "libinverse/spectral/choices/evidence.hpp"

#include <cmath>

namespace modcal {

void Evidence::Options::visit(OptionVisitor& visitor) { curve.visit(visitor); }

Evidence::Evidence(const Options& options) : ParameterChoice(options.curve) {}

ParameterChoice::Pick Evidence::pick(const Regularizer& regularizer, const SpectralData& data,
                                     std::span<CurvePoint> curve) const {
  const SpectralOperator& problem = *data.problem;
  const double rows = static_cast<double>(problem.rows());
  const std::vector<double> sigma = penalized_sigma(regularizer, problem);
  std::vector<double> kept(sigma.size()), lost(sigma.size());
  for (CurvePoint& point : curve) {
    regularizer.filter_factors(sigma, point.parameter, kept, lost);
    double power = data.outside_power, logarithms = 0.0;
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      const double share = lost[i] > 0.0 ? lost[i] : 1.0 / (1.0 + rows);
      power += share * data.power[i];
      if (share < 1.0) logarithms += problem.multiplicity()[i] * std::log(share);
    }
    const double criterion = rows * std::log(power) - logarithms;
    if (std::isfinite(criterion)) point.criterion = criterion;
  }
  return smallest_criterion(curve, "negative logarithm of the evidence");
}

}  // namespace modcal
