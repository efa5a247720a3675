#include "libsim/model/modal_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace modcal::modal_model_test {
namespace {

constexpr std::size_t kModes = 7;

// Five sensors of all kinds and two contacts, complex constants, residual terms.
ModalModel plate() {
  ModalModel model;
  for (std::size_t n = 0; n < kModes; ++n) {
    const double place = static_cast<double>(n);
    model.poles.push_back({300.0 + 170.0 * place, 0.004 + 0.001 * place});
  }
  model.sensors = {SensorKind::kDisplacement, SensorKind::kVelocity, SensorKind::kAcceleration,
                   SensorKind::kForce, SensorKind::kStrain};
  model.contacts = 2;
  for (std::size_t i = 0; i < model.pairs() * kModes; ++i) {
    model.constants.push_back(std::sin(1.0 + 2.3 * static_cast<double>(i)));
    model.quadrature.push_back(0.2 * std::cos(0.7 * static_cast<double>(i)));
  }
  for (std::size_t i = 0; i < model.pairs(); ++i) {
    model.residuals.push_back(
        {.below = 0.1 * static_cast<double>(i + 1), .constant = 1e-6, .above = -2e-12});
  }
  return model;
}

// The sum over partial fractions r/(s − λ) + conj(r)/(s − conj(λ)), written for one pair.
Complex by_definition(const ModalModel& model, std::size_t pair, Complex s) {
  const int power = power_of_s(model.sensors[pair / model.contacts]);
  Complex sum = 0.0;
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    const double omega = model.poles[n].omega, zeta = model.poles[n].zeta;
    const Complex pole = omega * Complex(-zeta, std::sqrt(1.0 - zeta * zeta));
    const double a = model.constant(pair, n);
    const double b = model.quadrature.empty() ? 0.0 : model.quadrature[pair * kModes + n];
    const Complex numerator = power == 0 ? a + b * s / omega : a - b * omega / s;
    sum += numerator / ((s - pole) * (s - std::conj(pole)));
  }
  if (!model.residuals.empty()) {
    const ResidualTerms& c = model.residuals[pair];
    sum += c.below / (s * s) + c.constant + c.above * s * s;
  }
  return sum * std::pow(s, power);
}

TEST(ModalModel, IsTheSumOverPartialFractionsForEveryKindOfSensor) {
  const FrequencyGrid on_axis{.spacing = 11.0, .bins = 150};
  const FrequencyGrid shifted{.spacing = 11.0, .bins = 150, .sigma = 20.0};
  ModalModel real = plate();
  real.quadrature.clear();
  real.residuals.clear();
  for (const FrequencyGrid& grid : {on_axis, shifted}) {
    for (const ModalModel& model : {plate(), real}) {
      const auto transfer = model.transfer(grid);
      ASSERT_EQ(transfer.size(), 10u);
      for (std::size_t i = 0; i < model.pairs(); ++i) {
        for (std::size_t k = 1; k < grid.bins; ++k) {
          const Complex expected = by_definition(model, i, grid.s(k));
          EXPECT_NEAR(std::abs(transfer[i][k] - expected), 0.0, 1e-11 * std::abs(expected) + 1e-15)
              << i << " " << k;
        }
      }
    }
  }
}

TEST(ModalModel, NumeratorAtTheResonanceIsTheModalConstant) {
  ModalModel model = plate();
  model.residuals.clear();
  model.poles = {{400.0, 0.01}};
  model.contacts = 1;
  model.constants = {2.0, 2.0, 2.0, 2.0, 2.0};
  model.quadrature = {0.5, 0.5, 0.5, 0.5, 0.5};
  const auto transfer = model.transfer({.spacing = 400.0, .bins = 2});
  const Complex s(0.0, 400.0), constant(2.0, 0.5);
  for (std::size_t i = 0; i < 5; ++i) {
    const Complex expected =
        std::pow(s, power_of_s(model.sensors[i])) * constant / model.poles[0].denominator(s);
    EXPECT_NEAR(std::abs(transfer[i][1] / expected - 1.0), 0.0, 1e-13);
  }
}

TEST(ModalModel, PoleSlopesAreThoseOfCentralDifferences) {
  const Complex s(3.0, 640.0);
  const FrequencyGrid grid{.spacing = 640.0, .bins = 2, .sigma = 3.0};
  for (const bool by_omega : {true, false}) {
    std::vector<Complex> slopes(plate().pairs());
    plate().pole_slopes(2, s, by_omega ? 1.0 : 0.0, by_omega ? 0.0 : 1.0, slopes);
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const double step = by_omega ? 1e-3 : 1e-7;
      ModalModel above = plate(), below = plate();
      (by_omega ? above.poles[2].omega : above.poles[2].zeta) += step;
      (by_omega ? below.poles[2].omega : below.poles[2].zeta) -= step;
      const Complex difference =
          (above.transfer(grid)[i][1] - below.transfer(grid)[i][1]) / (2.0 * step);
      EXPECT_NEAR(std::abs(difference / slopes[i] - 1.0), 0.0, 1e-5) << i << by_omega;
    }
  }
}

TEST(ModalModel, SensorsCanBeChosenAndBlocksChangeNoBit) {
  const ModalModel model = plate();
  const FrequencyGrid grid{.spacing = 0.4, .bins = 5000};
  const auto all = model.transfer(grid);
  const auto chosen = model.with_sensors({4, 1}).transfer(grid);
  SplitSpectra blocks;
  model.evaluate_in_parallel(grid, {0, grid.bins}, blocks);
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t k = 1; k < grid.bins; ++k) {
      ASSERT_EQ(chosen[p][k], all[8 + p][k]);
      ASSERT_EQ(chosen[2 + p][k], all[2 + p][k]);
      ASSERT_EQ(blocks.at(8 + p, k), all[8 + p][k]);
    }
  }
}

TEST(ModalModel, AModeThatNothingDrivesIsLeftOut) {
  // Undamped and on a bin it would be 0/0.
  ModalModel model{.poles = {{100.0, 0.0}, {250.0, 0.01}},
                   .sensors = {SensorKind::kDisplacement},
                   .constants = {0.0, 1.0}};
  const auto transfer = model.transfer({.spacing = 100.0, .bins = 2});
  EXPECT_TRUE(std::isfinite(transfer[0][1].real()));
}

}  // namespace
}  // namespace modcal::modal_model_test
