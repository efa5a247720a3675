#include "libsim/signal/decimation.hpp"

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Half of the filter, from its middle on; its sum over both halves is 1.
std::vector<double> half_filter(std::size_t step) {
  const double reach = static_cast<double>(decimation_reach() * step);
  const double beta = 0.1102 * (80.0 - 8.7);  // of 80 dB
  std::vector<double> filter;
  double sum = 0.0;
  for (std::size_t j = 0; j <= decimation_reach() * step; ++j) {
    const double at = static_cast<double>(j),
                 angle = std::numbers::pi * at / static_cast<double>(step);
    const double sinc = j == 0 ? 1.0 : std::sin(angle) / angle;
    const double edge = at / reach;
    filter.push_back(sinc * std::cyl_bessel_i(0.0, beta * std::sqrt(1.0 - edge * edge)));
    sum += (j == 0 ? 1.0 : 2.0) * filter.back();
  }
  for (double& value : filter) value /= sum;
  return filter;
}

}  // namespace

std::vector<double> decimated(std::span<const double> samples, std::size_t step) {
  MODCAL_REQUIRE(step >= 1, "every {}-th sample: the step is 1 at least", step);
  if (step == 1) return {samples.begin(), samples.end()};
  const std::vector<double> filter = half_filter(step);
  const std::size_t reach = filter.size() - 1;
  std::vector<double> result;
  for (std::size_t at = 0; at + reach < samples.size(); at += step) {
    double sum = filter[0] * samples[at];
    for (std::size_t j = 1; j <= reach; ++j) {
      sum += filter[j] * (samples[at + j] + (j <= at ? samples[at - j] : 0.0));
    }
    result.push_back(sum);
  }
  return result;
}

}  // namespace modcal
