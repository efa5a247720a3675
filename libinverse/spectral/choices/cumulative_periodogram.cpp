#include "libinverse/spectral/choices/cumulative_periodogram.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {

void CumulativePeriodogram::Options::visit(OptionVisitor& visitor) { curve.visit(visitor); }

CumulativePeriodogram::CumulativePeriodogram(const Options& options)
    : ParameterChoice(options.curve) {}

ParameterChoice::Pick CumulativePeriodogram::pick(const Regularizer& regularizer,
                                                  const SpectralData& data,
                                                  std::span<CurvePoint> curve) const {
  const SpectralOperator& problem = *data.problem;
  const std::vector<double> sigma = penalized_sigma(regularizer, problem);
  std::vector<double> kept(sigma.size()), lost(sigma.size());
  std::vector<double> residual(sigma.size()), freedom(sigma.size());
  for (CurvePoint& point : curve) {
    regularizer.filter_factors(sigma, point.parameter, kept, lost);
    double total = 0.0, all = 0.0;
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      const std::uint32_t place = problem.order()[i];
      residual[place] = lost[i] * lost[i] * data.power[i];
      freedom[place] = problem.multiplicity()[i];
      total += residual[place];
      all += freedom[place];
    }
    if (!(total > 0.0)) continue;  // no residual: nothing to compare
    double sum = 0.0, white = 0.0, distance = 0.0;
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      sum += residual[i] / total;
      white += freedom[i] / all;
      distance = std::max(distance, std::abs(sum - white));
    }
    point.criterion = distance;
  }
  return smallest_criterion(curve, "distance of the residual from white noise");
}

}  // namespace modcal
