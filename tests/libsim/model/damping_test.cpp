#include "libsim/model/damping.hpp"

#include <gtest/gtest.h>

#include "libsim/base/error.hpp"
#include "libsim/model/constant_damping.hpp"
#include "libsim/model/measured_damping.hpp"
#include "libsim/model/polynomial_damping.hpp"

namespace modcal {
namespace {

const std::vector<double> kOmega = {1e3, 2e3, 3e3, 4e3, 5e3, 6e3};

TEST(Damping, ConstantAndPolynomialLawsAreTheirFormulas) {
  EXPECT_EQ(ConstantDamping({.ratio = 2e-3}).ratios(kOmega), std::vector<double>(6, 2e-3));
  const auto zeta = PolynomialDamping({.coefficients = {1e-3, 2e-4, 3e-5}}).ratios(kOmega);
  for (std::size_t i = 0; i < zeta.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    EXPECT_DOUBLE_EQ(zeta[i], 1e-3 + 2e-4 * n + 3e-5 * n * n);
  }
}

TEST(Damping, MeasuredRatiosAreExtrapolatedByTheirPolynomial) {
  MeasuredDamping::Options options;
  for (const std::int64_t n : {1, 2, 4}) {
    const auto number = static_cast<double>(n);
    options.modes.push_back(n);
    options.ratios.push_back(2e-4 + 1e-5 * number + 2e-6 * number * number);
  }
  const auto zeta = MeasuredDamping(options).ratios(kOmega);
  for (std::size_t i = 0; i < zeta.size(); ++i) {
    const auto n = static_cast<double>(i + 1);
    // Three points fix the parabola; QR of a 3 x 3 matrix with condition below 1e3.
    EXPECT_NEAR(zeta[i], 2e-4 + 1e-5 * n + 2e-6 * n * n, 1e-15);
  }
  options.ratios.pop_back();
  EXPECT_THROW(MeasuredDamping{options}, InvalidInput);
}

TEST(Damping, RefusesModesThatDoNotOscillate) {
  EXPECT_THROW(PolynomialDamping({.coefficients = {0.0, 0.2}}).ratios(kOmega), InvalidInput);
  EXPECT_THROW(PolynomialDamping({.coefficients = {1e-3, -1e-3}}).ratios(kOmega), InvalidInput);
}

}  // namespace
}  // namespace modcal
