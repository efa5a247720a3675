// Two modes that stand closer together than they are wide, taken for one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libinverse/structure/strikes/strike_fit.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"

namespace modcal::merged_modes_test {
namespace {

constexpr std::size_t kSensors = 3;

// Lines of 2 % noise of a mode at 110 Hz and a pair at 173 Hz, 2 Hz apart: 1.2 half-widths.
MeasuredFunctions lines_of(const double (&pair)[kSensors][2]) {
  const std::vector<ModalPole> poles = {
      {kTurn * 110.0, 0.02}, {kTurn * 172.0, 0.01}, {kTurn * 174.0, 0.01}};
  const FrequencyGrid grid{.spacing = kTurn * 0.5, .bins = 601};
  std::vector<double> normal(2 * kSensors * grid.bins);
  fill_standard_normal(StreamKey(7).with("lines"), normal);
  std::vector<std::vector<Complex>> response(kSensors, std::vector<Complex>(grid.bins));
  for (std::size_t k = 0; k < kSensors; ++k) {
    for (std::size_t m = 0; m < grid.bins; ++m) {
      const Complex s = grid.s(m);
      for (std::size_t n = 0; n < poles.size(); ++n) {
        const double constant = n == 0 ? 1.0 : pair[k][n - 1];
        const auto& [omega, zeta] = poles[n];
        response[k][m] += constant / (s * s + 2.0 * zeta * omega * s + omega * omega);
      }
      const double* z = &normal[2 * (k * grid.bins + m)];
      response[k][m] *= 1.0 + 0.02 / std::sqrt(2.0) * Complex(z[0], z[1]);
    }
  }
  return {.grid = grid,
          .sensors = std::vector<SensorKind>(kSensors, SensorKind::kDisplacement),
          .sessions = {response}};
}

StrikeFit fit_of(const double (&pair)[kSensors][2]) {
  return fit_response(lines_of(pair), {.low = 61.0, .high = 239.0, .most_modes = 2});
}

// One pole for both: it lies between, and the sensors, which see other shares of the two, pull it
// apart by more than what is left of them expects.
TEST(MergedModes, AreDoubtedWhereTheSensorsPullThemApart) {
  const StrikeFit merged = fit_of({{1.0, 0.2}, {0.3, 0.9}, {0.8, -0.1}});
  ASSERT_EQ(merged.table.model.poles.size(), 2u);
  EXPECT_EQ(merged.disputed, std::vector<std::size_t>{1});
  const double found = merged.table.frequency(1);
  const double deviation = found * merged.table.frequency_deviations[1];
  EXPECT_LT(std::min(std::abs(found - 172.0), std::abs(found - 174.0)), 2.0 * deviation);
  // One mode alone.
  EXPECT_TRUE(fit_of({{1.0, 0.0}, {0.3, 0.0}, {0.8, 0.0}}).disputed.empty());
}

// A blow of 10 ms that one sensor answers for 3 s, with 2 % of its rms in noise.
StrikeFit fit_of_blow(const std::vector<ModalPole>& poles, const std::vector<double>& constants) {
  constexpr double rate = 1200.0;
  constexpr std::size_t samples = 3600, blow = 12;
  StructureRecord record{.sample_rate = rate, .force = std::vector<double>(samples, 0.0)};
  std::vector<double>& response = record.responses.emplace_back(samples, 0.0);
  for (std::size_t i = 1; i < blow; ++i) {
    const double sine = std::sin(0.5 * kTurn * static_cast<double>(i) / blow);
    record.force[i] = 50.0 * sine * sine;
  }
  for (std::size_t n = 0; n < poles.size(); ++n) {
    const auto [omega, zeta] = poles[n];
    const double damped = omega * std::sqrt(1.0 - zeta * zeta);
    for (std::size_t i = 1; i < blow; ++i) {
      for (std::size_t j = i; j < samples; ++j) {
        const double t = static_cast<double>(j - i) / rate;
        response[j] += record.force[i] / rate * constants[n] / damped *
                       std::exp(-zeta * omega * t) * std::sin(damped * t);
      }
    }
  }
  double power = 0.0;
  for (const double x : response) power += x * x / samples;
  std::vector<double> normal(samples);
  fill_standard_normal(StreamKey(3).with("noise"), normal);
  for (std::size_t j = 0; j < samples; ++j) response[j] += 0.02 * std::sqrt(power) * normal[j];
  return fit_strikes({record}, {SensorKind::kDisplacement},
                     {.low = 20.0, .high = 300.0, .most_modes = 2});
}

// On the contour of 20/T, by which a tenth of the record counts, the two are one.
TEST(MergedModes, AreDoubtedByWhatRingsLate) {
  const ModalPole low{kTurn * 40.0, 0.006}, first{kTurn * 71.0, 0.009}, second{kTurn * 72.4, 0.009};
  const StrikeFit merged = fit_of_blow({low, first, second}, {1.0, 0.6, 0.4});
  ASSERT_EQ(merged.table.model.poles.size(), 2u);
  EXPECT_EQ(merged.doubled, std::vector<std::size_t>{1});
  const double found = merged.table.frequency(1);
  const double deviation = found * merged.table.frequency_deviations[1];
  EXPECT_LT(std::min(std::abs(found - 71.0), std::abs(found - 72.4)), 2.0 * deviation);
  const StrikeFit alone = fit_of_blow({low, first}, {1.0, 0.6});
  EXPECT_TRUE(alone.doubled.empty());
  EXPECT_LT(alone.table.frequency(1) * alone.table.frequency_deviations[1], 0.1 * deviation);
}

}  // namespace
}  // namespace modcal::merged_modes_test
