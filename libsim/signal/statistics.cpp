#include "libsim/signal/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

void require_same_length(std::span<const double> x, std::span<const double> y) {
  MODCAL_REQUIRE(x.size() == y.size() && !x.empty(),
                 "two sequences of {} and {} samples cannot be compared: they need one length > 0",
                 x.size(), y.size());
}

}  // namespace

double mean(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

double standard_deviation(std::span<const double> x) {
  const double average = mean(x);
  double sum = 0.0;
  for (const double value : x) sum += (value - average) * (value - average);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

double largest_magnitude(std::span<const double> x) {
  double largest = 0.0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  return largest;
}

double correlation(std::span<const double> x, std::span<const double> y) {
  require_same_length(x, y);
  const double mean_x = mean(x);
  const double mean_y = mean(y);
  double xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - mean_x;
    const double dy = y[i] - mean_y;
    xx += dx * dx;
    yy += dy * dy;
    xy += dx * dy;
  }
  if (!(xx > 0.0) || !(yy > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return xy / (std::sqrt(xx) * std::sqrt(yy));
}

double relative_rms_error(std::span<const double> x, std::span<const double> y) {
  require_same_length(x, y);
  const double shift = mean(x) - mean(y);
  const double mean_y = mean(y);
  double error = 0.0, power = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double difference = x[i] - y[i] - shift;
    error += difference * difference;
    power += (y[i] - mean_y) * (y[i] - mean_y);
  }
  if (!(power > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt(error / power);
}

void remove_mean(std::span<double> x) {
  const double average = mean(x);
  for (double& value : x) value -= average;
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double position = q * static_cast<double>(values.size() - 1);
  const auto lower = static_cast<std::size_t>(position);
  const std::size_t upper = std::min(lower + 1, values.size() - 1);
  return std::lerp(values[lower], values[upper], position - static_cast<double>(lower));
}

double student_quantile(std::size_t degrees) {
  constexpr double z = 1.959964, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  if (degrees == 0) return z;
  // The expansion does not reach one degree of freedom, Cauchy's distribution.
  if (degrees == 1) return std::tan(0.475 * std::numbers::pi);
  const double n = static_cast<double>(degrees);
  return z + (z3 + z) / (4.0 * n) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n) +
         (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n * n * n);
}

}  // namespace modcal
