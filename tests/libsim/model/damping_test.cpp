#include "libsim/model/damping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal::damping_test {
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

TEST(Damping, ATableIsLinearBetweenItsPoints) {
  const TableDamping law({.frequencies = {100.0, 200.0, 400.0}, .ratios = {1e-3, 3e-3, 2e-3}});
  const double turn = 2.0 * std::numbers::pi;
  const auto zeta = law.ratios(std::vector<double>{50.0 * turn, 150.0 * turn, 300.0 * turn, 1e5});
  EXPECT_EQ(zeta[0], 1e-3);
  EXPECT_NEAR(zeta[1], 2e-3, 1e-17);
  EXPECT_NEAR(zeta[2], 2.5e-3, 1e-17);
  EXPECT_EQ(zeta[3], 2e-3);
  EXPECT_THROW(TableDamping({.frequencies = {2.0, 1.0}, .ratios = {0.1, 0.1}}), InvalidInput);
  EXPECT_THROW(TableDamping({.frequencies = {2.0}, .ratios = {}}), InvalidInput);
}

// L = 1 m, ρ_L = 0.01 kg/m, T = 100 N, B = 1e-2: EI = B T L²/π² = 1/π² N m².
const StringConstants kString = {1.0, 0.01, 100.0, 1e-2};

TEST(Damping, WoodhousesLawWeighsTensionAndBending) {
  const WoodhouseDamping law({.friction = 2e-4, .air = 1.0, .bending = 0.02});
  const auto zeta = law.ratios(std::vector<double>{1000.0, 2000.0, 3000.0}, kString);
  // n = 1: (2e-4 + 1e-3 + 0.02·0.01)/(1.01)/2; n = 3: (2e-4 + 1/3000 + 0.02·0.09)/1.09/2.
  EXPECT_DOUBLE_EQ(zeta[0], 1.4e-3 / 2.02);
  EXPECT_DOUBLE_EQ(zeta[2], (2e-4 + 1.0 / 3000.0 + 1.8e-3) / 2.18);
  // The bending term is that of the stated equation: EI (nπ/L)² against T.
  const double bending =
      (1.0 / (std::numbers::pi * std::numbers::pi)) * std::pow(2.0 * std::numbers::pi, 2);
  EXPECT_NEAR(zeta[1], 0.5 * (100.0 * (2e-4 + 1.0 / 2000.0) + bending * 0.02) / (100.0 + bending),
              1e-18);
}

TEST(Damping, ValetteAndCuestasTermsAddUp) {
  const double omega = 2.0 * std::numbers::pi * 100.0;
  const std::vector<double> modes = {omega};
  const auto zeta = [&](ValetteCuestaDamping::Options options) {
    return ValetteCuestaDamping(options).ratios(modes, kString)[0];
  };
  // Air, d = 1 mm: R = 1.13097336e-4 + 6.28318531e-3·√(π·1.8e-5·1.2·100) = 6.306823e-4 kg/(m s);
  // 1/Q = R/(0.01·628.3185307) = 1.0037621e-4.
  EXPECT_NEAR(zeta({.diameter = 1e-3, .loss_angle = 0.0, .constant = 0.0}), 0.5 * 1.0037621e-4,
              1e-12);
  // Viscoelastic: 4π²·0.01·(1/π²)·0.01·1e4/1e4 = 4e-4.
  EXPECT_NEAR(zeta({.diameter = 1e-3, .loss_angle = 0.01, .constant = 0.0, .air_viscosity = 0.0}),
              2e-4, 1e-17);
  EXPECT_NEAR(zeta({.diameter = 1e-3, .loss_angle = 0.0, .constant = 3e-4, .air_viscosity = 0.0}),
              1.5e-4, 1e-17);
  // A string that says nothing of itself has no such losses: a refusal, not a NaN.
  EXPECT_THROW(
      ValetteCuestaDamping({.diameter = 1e-3, .loss_angle = 0.01, .constant = 0.0}).ratios(modes),
      InvalidInput);
}

TEST(Damping, RefusesModesThatDoNotOscillate) {
  EXPECT_THROW(PolynomialDamping({.coefficients = {0.0, 0.2}}).ratios(kOmega), InvalidInput);
  EXPECT_THROW(PolynomialDamping({.coefficients = {1e-3, -1e-3}}).ratios(kOmega), InvalidInput);
}

}  // namespace
}  // namespace modcal::damping_test
