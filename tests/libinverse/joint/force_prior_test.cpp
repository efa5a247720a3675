#include "libinverse/joint/force_prior.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/random.hpp"

namespace modcal::force_prior_test {
namespace {

std::vector<double> box_means(const std::vector<double>& values, std::size_t half) {
  std::vector<double> means(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t low = k > half ? k - half : 0, high = std::min(values.size(), k + half + 1);
    for (std::size_t j = low; j < high; ++j) means[k] += values[j];
    means[k] /= static_cast<double>(high - low);
  }
  return means;
}

class Width : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};
INSTANTIATE_TEST_SUITE_P(SmoothPower, Width,
                         testing::Combine(testing::Values(1, 5, 12, 100),
                                          testing::Values(1, 7, 11, 44, 45, 97, 1009, 4000)));

TEST_P(Width, IsTwoMeansOverABox) {
  const auto [half, bins] = GetParam();
  std::vector<double> power(bins), scratch(bins);
  fill_standard_normal(StreamKey(3), power);
  // 20 decades: what a window has passed must leave no rounding behind.
  for (std::size_t k = 0; k < bins; ++k) {
    power[k] = power[k] * power[k] *
               std::pow(10.0, -20.0 * static_cast<double>(k) / static_cast<double>(bins));
  }
  const std::vector<double> expected = box_means(box_means(power, half), half);
  smooth_power(power, scratch, static_cast<double>(half), 0.0);
  // Sums of positive terms, at most 201 of them, twice; short spectra slide their window and begin
  // anew at 1e-6 of what has been.
  const double tolerance = bins >= 4 * (2 * half + 1) ? 1e-13 : 1e-9;
  for (std::size_t k = 0; k < bins; ++k) {
    EXPECT_NEAR(power[k], expected[k], tolerance * expected[k]) << k;
  }
}

TEST(JumpPrior, IsTheSpectrumOfAFirstOrderProcess) {
  const PriorGrid grid{.bins = 5001, .samples = 10000, .sample_rate = 51200.0};
  std::vector<double> variance(grid.bins);
  JumpPrior(JumpPrior::Options{.corner = 50.0}).shape(grid, variance);
  const auto expected = [&](std::size_t k) {
    const double x = std::sin(std::numbers::pi * static_cast<double>(k) / 10000.0);
    const double corner = std::sin(std::numbers::pi * 50.0 / 51200.0);
    return 1.0 / (x * x + corner * corner);
  };
  double sum = 0.0;
  for (std::size_t k = 0; k < grid.bins; ++k) sum += expected(k);
  for (std::size_t k = 0; k < grid.bins; ++k) {
    // 1 − cos loses what rounding is of the corner's square, 1e-16/1e-5.
    EXPECT_NEAR(variance[k] * sum / (expected(k) * 5001.0), 1.0, 1e-10) << k;
  }
}

}  // namespace
}  // namespace modcal::force_prior_test
