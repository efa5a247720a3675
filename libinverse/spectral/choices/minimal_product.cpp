#include "libinverse/spectral/choices/minimal_product.hpp"

#include <fmt/format.h>

#include "libinverse/spectral/problem/interior_minimum.hpp"

namespace modcal {

ParameterChoice::Pick MinimalProduct::pick(const Regularizer& /*regularizer*/,
                                           const SpectralData& /*data*/,
                                           std::span<CurvePoint> curve) const {
  std::vector<double> product(curve.size());
  for (std::size_t j = 0; j < curve.size(); ++j) {
    product[j] = curve[j].residual_norm * curve[j].solution_norm;
    curve[j].criterion = product[j];
  }
  const auto minimum = most_prominent_minimum(product);
  if (!minimum) {
    return {curve.front().parameter, ChoiceStatus::kNoInteriorMinimum,
            fmt::format("the product has no local minimum between {:.4g} and {:.4g}; the lowest "
                        "parameter stands in",
                        curve.front().parameter, curve.back().parameter)};
  }
  const double parameter = curve[minimum->index].parameter;
  return {parameter, ChoiceStatus::kChosen,
          fmt::format("most prominent of {} interior local minima of the product at {:.4g}, {:.3f} "
                      "decades below its lower barrier",
                      minimum->count, parameter, minimum->prominence)};
}

}  // namespace modcal
