#include <gtest/gtest.h>

#include "libsim/base/error.hpp"
#include "libsim/model/damping.hpp"

namespace modcal::damping_fit_test {
namespace {

TEST(DampingFit, IsExactOnPolynomialsOfItsDegree) {
  // Eleven measured modes, extrapolated to 55: the condition of a quadratic on 11 points is about
  // 50, that of reaching 5 times beyond them 25 times more.
  std::vector<std::size_t> modes;
  std::vector<double> ratios;
  const auto polynomial = [](double n) { return 2e-4 + 3e-6 * n + 5e-8 * n * n; };
  for (std::size_t n = 1; n <= 11; ++n) {
    modes.push_back(n);
    ratios.push_back(polynomial(static_cast<double>(n)));
  }
  const DampingFit fit = fit_damping(modes, ratios);
  ASSERT_EQ(fit.coefficients.size(), 3u);
  EXPECT_NEAR(fit.coefficients[0], 2e-4, 2e-16);
  EXPECT_NEAR(fit.coefficients[2], 5e-8, 1e-17);
  EXPECT_NEAR(fit.ratio(55), polynomial(55.0), 1e-14);
  EXPECT_LT(fit.rms_residual, 1e-18);
}

TEST(DampingFit, AveragesScatterInTheLeastSquaresSense) {
  const std::vector<std::size_t> modes = {1, 2, 3, 4};
  const DampingFit fit = fit_damping(modes, std::vector<double>{1e-3, 2e-3, 3e-3, 2e-3}, 0);
  EXPECT_NEAR(fit.ratio(7), 2e-3, 1e-17);
  EXPECT_NEAR(fit.rms_residual, std::sqrt(0.5) * 1e-3, 1e-15);
}

TEST(DampingFit, RefusesTooFewOrRepeatedModes) {
  const std::vector<double> two = {1e-3, 2e-3};
  EXPECT_THROW(fit_damping(std::vector<std::size_t>{1, 2}, two), InvalidInput);
  EXPECT_THROW(fit_damping(std::vector<std::size_t>{2, 2}, two, 1), InvalidInput);
  EXPECT_THROW(fit_damping(std::vector<std::size_t>{0, 2}, two, 1), InvalidInput);
  EXPECT_THROW(fit_damping(std::vector<std::size_t>{1}, two, 0), InvalidInput);
}

}  // namespace
}  // namespace modcal::damping_fit_test
