#include "libinverse/regularizer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>

#include "libinverse/spectral/problem/spectral_system.hpp"
#include "libinverse/spectral/regularizers/filter_terms.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

void require_parameter(double parameter) {
  MODCAL_REQUIRE(parameter >= 0.0 && std::isfinite(parameter),
                 "regularization parameter {:g} is not a finite number >= 0", parameter);
}

double reference_of(const SpectralOperator& problem) {
  const std::span<const double> omega = problem.omega();
  MODCAL_REQUIRE(!omega.empty() || problem.size() == 0,
                 "this regularizer weighs frequencies and the problem has none: use one of order "
                 "0, or prepare "
                 "the matrix for this regularizer");
  double square = 0.0;
  for (const double value : omega) square += value * value;
  return omega.empty() ? 1.0 : std::sqrt(square / static_cast<double>(omega.size()));
}

// A system whose components stand in the order of falling penalized singular values.
struct PenalizedSystem {
  std::vector<double> sigma, multiplicity, power, solution_weight;
  SpectralSystem system;

  PenalizedSystem(const Regularizer& regularizer, const SpectralSystem& original)
      : system(original) {
    const std::vector<double> penalized = penalized_sigma(regularizer, *original.problem);
    std::vector<std::uint32_t> order(penalized.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&penalized](std::uint32_t a, std::uint32_t b) {
      return penalized[a] > penalized[b];
    });
    const auto reordered = [&order](std::span<const double> values) {
      std::vector<double> result;
      result.reserve(order.size());
      for (const std::uint32_t i : order) result.push_back(values[i]);
      return result;
    };
    sigma = reordered(penalized);
    multiplicity = reordered(original.multiplicity);
    power = reordered(original.power);
    solution_weight = reordered(original.solution_weight);
    system.sigma = sigma;
    system.multiplicity = multiplicity;
    system.power = power;
    system.solution_weight = solution_weight;
  }
};

}  // namespace

std::vector<double> penalized_sigma(const Regularizer& regularizer,
                                    const SpectralOperator& problem) {
  std::vector<double> result(problem.sigma().begin(), problem.sigma().end());
  if (!regularizer.has_penalty() || problem.penalized()) return result;
  const double reference = reference_of(problem);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] /= regularizer.penalty(problem.omega()[i], reference);
  }
  return result;
}

std::vector<double> penalized_sigma_as_given(const Regularizer& regularizer,
                                             const SpectralOperator& problem) {
  const std::vector<double> sorted = penalized_sigma(regularizer, problem);
  std::vector<double> result(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) result[problem.order()[i]] = sorted[i];
  return result;
}

std::vector<double> falling_penalized_sigma(const Regularizer& regularizer,
                                            const SpectralOperator& problem) {
  std::vector<double> result = penalized_sigma(regularizer, problem);
  std::sort(result.begin(), result.end(), std::greater<>());
  return result;
}

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
  if (has_penalty()) {
    const PenalizedSystem penalized(*this, system);
    do_trace_squares(penalized.system, parameters, curve);
  } else {
    do_trace_squares(system, parameters, curve);
  }
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
