#include "libinverse/joint/force_prior.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

void ForcePrior::shape(const PriorGrid& grid, std::span<double> variance) const {
  MODCAL_REQUIRE(variance.size() == grid.bins, "{} variances for {} bins", variance.size(),
                 grid.bins);
  do_shape(grid, variance);
  double sum = 0.0;
  for (const double value : variance) sum += value;
  const double scale = static_cast<double>(grid.bins) / sum;
  for (double& value : variance) value *= scale;
}

void ForcePrior::learn(const PriorGrid& grid, std::span<double> power,
                       std::span<double> scratch) const {
  MODCAL_REQUIRE(power.size() == grid.bins && scratch.size() == power.size(),
                 "{} powers and {} places for {} bins", power.size(), scratch.size(), grid.bins);
  do_learn(grid, power, scratch);
}

void ForcePrior::do_learn(const PriorGrid& /*grid*/, std::span<double> /*power*/,
                          std::span<double> /*scratch*/) const {}

namespace {

// The window slides: a bin enters once and leaves once. Bins far apart in power follow each other,
// so the sum is begun anew where what has left outweighs what is left.
void box_mean(std::span<const double> in, std::span<double> out, double at_zero, double slope) {
  const std::size_t n = in.size();
  std::size_t begin = 0, end = 0;
  double sum = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const auto half = static_cast<std::size_t>(at_zero + slope * static_cast<double>(k));
    const std::size_t low = k > half ? k - half : 0;
    const std::size_t high = std::min(n, k + half + 1);
    for (; end < high; ++end) sum += in[end];
    for (; begin < low; ++begin) sum -= in[begin];
    largest = std::max(largest, sum);
    if (sum < 1e-6 * largest) {
      sum = 0.0;
      for (std::size_t j = low; j < high; ++j) sum += in[j];
      largest = sum;
    }
    out[k] = sum / static_cast<double>(high - low);
  }
}

}  // namespace

void smooth_power(std::span<double> power, std::span<double> scratch, double bins_at_zero,
                  double bins_per_bin) {
  box_mean(power, scratch, bins_at_zero, bins_per_bin);
  box_mean(scratch, power, bins_at_zero, bins_per_bin);
}

}  // namespace modcal
