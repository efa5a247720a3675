#include "libinverse/spectral/problem/spectral_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Below it σ² is no normal number and 1/σ² has no digits left.
// Fixed by: the square root of the smallest normal double.
constexpr double kSmallestSingularValue = 1.5e-154;

void require_non_negative(std::span<const double> values, const char* what) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    MODCAL_REQUIRE(values[i] >= 0.0 && std::isfinite(values[i]),
                   "{} {:g} of component {} is not a finite number >= 0", what, values[i], i);
  }
}

std::vector<std::uint32_t> falling_order(std::span<const double> values) {
  std::vector<std::pair<double, std::uint32_t>> keys(values.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    keys[i] = {-values[i], static_cast<std::uint32_t>(i)};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(keys.size());
  std::transform(keys.begin(), keys.end(), order.begin(),
                 [](const auto& key) { return key.second; });
  return order;
}

std::vector<double> reordered(std::span<const double> values,
                              std::span<const std::uint32_t> order) {
  std::vector<double> result(order.size());
  std::transform(order.begin(), order.end(), result.begin(),
                 [values](std::uint32_t i) { return values[i]; });
  return result;
}

}  // namespace

SpectralOperator::SpectralOperator(std::vector<double> singular_values,
                                   std::vector<double> multiplicity,
                                   std::vector<double> derivative_weight, std::size_t rows,
                                   bool penalized)
    : sigma_as_given_(std::move(singular_values)), rows_(rows), penalized_(penalized) {
  MODCAL_REQUIRE(
      multiplicity.size() == sigma_as_given_.size() &&
          (derivative_weight.empty() || derivative_weight.size() == multiplicity.size()),
      "{} singular values need as many multiplicities (given: {}) and derivative weights "
      "(given: {})",
      sigma_as_given_.size(), multiplicity.size(), derivative_weight.size());
  require_non_negative(sigma_as_given_, "singular value");
  require_non_negative(multiplicity, "multiplicity");
  require_non_negative(derivative_weight, "derivative weight");
  for (double& sigma : sigma_as_given_) {
    if (sigma < kSmallestSingularValue) sigma = 0.0;
  }
  order_ = falling_order(sigma_as_given_);
  sigma_ = reordered(sigma_as_given_, order_);
  multiplicity_ = reordered(multiplicity, order_);
  freedom_ = std::accumulate(multiplicity_.begin(), multiplicity_.end(), 0.0);
  zeros_ = static_cast<std::size_t>(std::count(sigma_.begin(), sigma_.end(), 0.0));
  inverse_square_.resize(sigma_.size());
  std::transform(sigma_.begin(), sigma_.end(), inverse_square_.begin(),
                 [](double sigma) { return sigma > 0.0 ? 1.0 / (sigma * sigma) : 0.0; });
  if (derivative_weight.empty()) return;
  derivative_weight_ = reordered(derivative_weight, order_);
  omega_.resize(derivative_weight_.size());
  std::transform(derivative_weight_.begin(), derivative_weight_.end(), omega_.begin(),
                 [](double square) { return std::sqrt(square); });
  std::transform(derivative_weight_.begin(), derivative_weight_.end(), inverse_square_.begin(),
                 derivative_weight_.begin(), std::multiplies<>());
}

std::span<const double> SpectralOperator::solution_weight(Measure measure) const {
  if (measure == Measure::kSolution) return inverse_square_;
  MODCAL_REQUIRE(derivative_weight_.size() == size(),
                 "this problem has no time, so its solution has no derivative: set the measure to "
                 "\"solution\"");
  return derivative_weight_;
}

SpectralSystem::SpectralSystem(const SpectralData& data, Measure measure)
    : problem(data.problem),
      sigma(data.problem->sigma()),
      multiplicity(data.problem->multiplicity()),
      power(data.power),
      solution_weight(data.problem->solution_weight(measure)),
      outside_power(data.outside_power) {
  assert(power.size() == sigma.size());
}

}  // namespace modcal
