#include "libinverse/spectral/choices/quasi_optimality.hpp"

#include <cmath>

namespace modcal {

void QuasiOptimality::Options::visit(OptionVisitor& visitor) { curve.visit(visitor); }

QuasiOptimality::QuasiOptimality(const Options& options) : ParameterChoice(options.curve) {}

ParameterChoice::Pick QuasiOptimality::pick(const Regularizer& regularizer,
                                            const SpectralData& data,
                                            std::span<CurvePoint> curve) const {
  const SpectralSystem system(data, measure());
  const std::vector<double> sigma = penalized_sigma(regularizer, *data.problem);
  std::vector<double> kept(sigma.size()), before(sigma.size());
  for (std::size_t j = 0; j < curve.size(); ++j) {
    regularizer.filter_factors(sigma, curve[j].parameter, kept);
    if (j > 0) {
      double square = 0.0;
      for (std::size_t i = 0; i < kept.size(); ++i) {
        const double step = kept[i] - before[i];
        square += step * step * system.solution_weight[i] * system.power[i];
      }
      const double width = std::log(curve[j].parameter / curve[j - 1].parameter);
      if (square > 0.0) curve[j].criterion = std::sqrt(square) / width;
    }
    kept.swap(before);
  }
  return smallest_criterion(curve, "change of the solution");
}

}  // namespace modcal
