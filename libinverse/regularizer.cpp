#include "libinverse/regularizer.hpp"

#include <cassert>
#include <cmath>
#include <limits>

#include "libinverse/filter_terms.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

void require_parameter(double parameter) {
  MODCAL_REQUIRE(parameter >= 0.0 && std::isfinite(parameter),
                 "regularization parameter {:g} is not a finite number >= 0", parameter);
}

}  // namespace

void Regularizer::filter_factors(std::span<const double> sigma, double parameter,
                                 std::span<double> kept, std::span<double> lost) const {
  assert(sigma.size() == kept.size() && (lost.empty() || sigma.size() == lost.size()));
  require_parameter(parameter);
  do_filter_factors(sigma, parameter, kept, lost);
}

void Regularizer::trace(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const {
  assert(parameters.size() == curve.size());
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    require_parameter(parameters[j]);
    MODCAL_REQUIRE(j == 0 || parameters[j] >= parameters[j - 1],
                   "regularization parameters must not fall: {:g} follows {:g}", parameters[j],
                   parameters[j - 1]);
  }
  do_trace_squares(system, parameters, curve);
  for (std::size_t j = 0; j < curve.size(); ++j) {
    CurvePoint& point = curve[j];
    point.parameter = parameters[j];
    point.residual_norm = std::sqrt(point.residual_norm);
    point.solution_norm = std::sqrt(point.solution_norm);
    point.criterion = std::numeric_limits<double>::quiet_NaN();
  }
}

void Regularizer::do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                                   std::span<CurvePoint> curve) const {
  sum_filtered(*this, terms_of(system), parameters, curve);
}

}  // namespace modcal
