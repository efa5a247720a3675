// Two modes of a structure from a strike and from its response functions.
#include "libinverse/structure/strikes/strike_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"

namespace modcal::strike_fit_test {
namespace {

const std::vector<ModalPole> kPoles = {{kTurn * 110.0, 0.02}, {kTurn * 173.0, 0.01}};
const std::vector<SensorKind> kKinds(2, SensorKind::kDisplacement);
constexpr double kConstants[2][2] = {{1.0, -0.7}, {0.4, 1.2}};  // by sensor and mode

// Each bin off by 2 % of itself, as the fit takes it; frequencies off by a share of `shift`.
MeasuredFunctions lines_of(std::uint64_t seed, double shift = 0.0) {
  FrequencyGrid grid{.spacing = kTurn * 2.5, .bins = 201};
  std::vector<double> normal(4 * grid.bins);
  fill_standard_normal(StreamKey(seed).with("lines"), normal);
  std::vector<std::vector<Complex>> response(2, std::vector<Complex>(grid.bins));
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t m = 0; m < grid.bins; ++m) {
      for (std::size_t n = 0; n < 2; ++n) {
        const double omega = kPoles[n].omega * std::exp(shift), zeta = kPoles[n].zeta;
        const Complex s = grid.s(m);
        response[k][m] += kConstants[k][n] / (s * s + 2.0 * zeta * omega * s + omega * omega);
      }
      const double* z = &normal[2 * (k * grid.bins + m)];
      response[k][m] *= 1.0 + 0.02 / std::sqrt(2.0) * Complex(z[0], z[1]);
    }
  }
  return {.grid = grid, .sensors = kKinds, .sessions = {response}};
}

StrikeFit fit_of(const MeasuredFunctions& functions) {
  return fit_response(functions, {.low = 61.0, .high = 239.0, .most_modes = 2});
}

void expect_the_modes(const StructureTable& table, double tolerance) {
  ASSERT_EQ(table.model.poles.size(), 2u);
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_NEAR(table.model.poles[n].omega / kPoles[n].omega, 1.0, tolerance);
    EXPECT_NEAR(table.model.poles[n].zeta, kPoles[n].zeta, 10.0 * tolerance * kPoles[n].zeta);
  }
}

// 71 lines of two sensors tell n = 284 numbers, m modes take p = 6 m + 4: BIC = n ln(cost/n) + p ln
// n.
TEST(StrikeFit, OfResponseFunctionsCountsWhatItsModesTake) {
  const StrikeFit fit = fit_of(lines_of(1));
  expect_the_modes(fit.table, 5e-3);
  ASSERT_EQ(fit.steps.size(), 2u);
  for (const ModeCount& step : fit.steps) {
    const double n = 284.0, p = 6.0 * static_cast<double>(step.modes) + 4.0;
    const double cost = step.misfit * (n - p);
    EXPECT_NEAR(step.criterion, n * std::log(cost / n) + p * std::log(n), 1e-9) << step.modes;
  }
  // The fit has come to rest: the same cost over the same numbers.
  EXPECT_NEAR(fit.misfit / fit.steps[1].misfit, 1.0, 1e-3);
}

// Sessions whose frequencies lie 2e-3 apart, 10 times what the fit of one leaves (2 % a line:
// 2e-4).
TEST(StrikeFit, OfSeveralSessionsTellsHowFarAFurtherOneIsOff) {
  MeasuredFunctions functions = lines_of(1, -2e-3);
  for (const auto& [seed, shift] : {std::pair(2u, 0.0), std::pair(3u, 2e-3)}) {
    functions.sessions.push_back(lines_of(seed, shift).sessions[0]);
  }
  const StrikeFit fit = fit_of(functions);
  expect_the_modes(fit.table, 2e-3);
  // The common resonance is wider than that of each; the deviation holds it.
  for (std::size_t n = 0; n < 2; ++n) {
    EXPECT_NEAR(std::log(fit.table.model.poles[n].zeta / kPoles[n].zeta), 0.0,
                2.0 * fit.table.damping_deviations[n]);
    EXPECT_LT(fit.table.damping_deviations[n], 0.1);
  }
  ASSERT_EQ(fit.strikes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(fit.strikes[i].poles.size(), 2u);
    const double shift = 2e-3 * (static_cast<double>(i) - 1.0);
    for (std::size_t n = 0; n < 2; ++n) {
      EXPECT_NEAR(std::log(fit.strikes[i].poles[n].omega / kPoles[n].omega), shift, 6e-4);
    }
  }
  EXPECT_NEAR(fit.frequency_scatter, 2e-3, 3e-4);
  // What moves both modes alike: √(1 + 1/3) times 4.30/1.96, Student's t of 2 degrees over the
  // normal distribution's.
  for (const double deviation : fit.table.frequency_deviations) {
    EXPECT_NEAR(deviation, 2e-3 * std::sqrt(4.0 / 3.0) * 4.303 / 1.96, 1.2e-3);
  }
  // One alone tells its own error.
  const StrikeFit one = fit_of(lines_of(1));
  EXPECT_TRUE(std::isnan(one.frequency_scatter));
  EXPECT_LT(one.table.frequency_deviations[0], 4e-4);
}

TEST(StrikeFit, OfTheSameMeasurementTwiceIsRefused) {
  MeasuredFunctions functions = lines_of(1);
  functions.sessions.push_back(functions.sessions[0]);
  EXPECT_THROW(fit_of(functions), InvalidInput);
}

// An impulse of 1 N s on the first sample; the contour is 20 over the duration or high/50.
TEST(StrikeFit, OfAStrikeFindsTheModes) {
  constexpr double kRate = 20000.0;
  for (const double duration : {1.0, 8.0}) {
    const auto count = static_cast<std::size_t>(duration * kRate);
    StructureRecord record{.sample_rate = kRate, .force = std::vector<double>(count, 0.0)};
    record.force[0] = kRate;
    record.responses.assign(2, std::vector<double>(count));
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t j = 0; j < count; ++j) {
        const double t = static_cast<double>(j) / kRate;
        for (std::size_t n = 0; n < 2; ++n) {
          const auto [omega, zeta] = kPoles[n];
          const double damped = omega * std::sqrt(1.0 - zeta * zeta);
          record.responses[k][j] +=
              kConstants[k][n] / damped * std::exp(-zeta * omega * t) * std::sin(damped * t);
        }
      }
    }
    const StrikeFit fit =
        fit_strikes({record}, kKinds, {.low = 60.0, .high = 240.0, .most_modes = 2});
    EXPECT_EQ(fit.strikes[0].spectra.grid.sigma, std::min(20.0 / duration, 240.0 / 50.0));
    // Sums over samples instead of integrals: (ω/f_s)²/12 = 2e-4 of a response.
    expect_the_modes(fit.table, 1e-3);
  }
}

}  // namespace
}  // namespace modcal::strike_fit_test
