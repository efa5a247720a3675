#include "libinverse/modes/significant_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/libinverse/modes/pluck_case.hpp"

namespace modcal::significant_fit_test {
namespace {

std::vector<double> frequencies(const DampedSinusoidFit& fit) {
  std::vector<double> found;
  for (const DecayMode& mode : fit.modes) found.push_back(mode.pole.frequency);
  return found;
}

TEST(LargestByChance, HasTheProbabilityThatItStates) {
  // exp(−x/2) for two degrees of freedom, exp(−x/2)(1 + x/2) for four; steps of half a unit.
  const double two = largest_by_chance(1000, 2), four = largest_by_chance(1000, 4);
  EXPECT_NEAR(two, 2.0 * std::log(1e6), 0.5);
  EXPECT_LT(std::exp(-0.5 * four) * (1.0 + 0.5 * four), 1e-6);
  EXPECT_GT(std::exp(-0.5 * (four - 0.5)) * (1.0 + 0.5 * (four - 0.5)), 1e-6);
}

class SignificantFit : public testing::Test {
 protected:
  // The second is as weak as a mode may be: Σ|A|²/2σ² Σ exp(−2dt) = .1²/(2 .05²) 400/(2 d T) = 318
  // with d = .01 2π 40 = 2.5/s, T = 2 s, 200 Hz.
  const std::vector<DecayMode> truth_ = {
      {.pole = {20.0, 0.01}, .amplitude = {{1.0, 0.5}, {-0.3, 0.2}}},
      {.pole = {40.0, 0.01}, .amplitude = {{0.1, 0.0}, {0.0, 0.1}}}};
  DecayRecord noisy(std::uint64_t seed) const {
    DecayRecord record = decay_of(truth_, 2, 200.0, 400);
    add_noise(record, 0.05, seed);
    return record;
  }
};

TEST_F(SignificantFit, LeavesOutPolesOfNoiseAndNoOther) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const DampedSinusoidFit fit = fit_significant(
        noisy(seed), {{20.0, 0.01}, {40.0, 0.01}, {62.0, 0.005}, {75.0, 0.005}, {90.0, 0.005}}, 2.0,
        {});
    ASSERT_TRUE(fit.converged) << seed;
    // σ_f = σ_d/2π = √(8 d³/f_s) σ/|A|/2π, .04 Hz of the second; .02 Hz and more for a pole beside.
    EXPECT_THAT(frequencies(fit), testing::ElementsAre(testing::DoubleNear(20.0, 0.1),
                                                       testing::DoubleNear(40.0, 0.4)))
        << seed;
  }
}

// Either of the two may hold a part of the mode; without the lesser one the other holds it all.
TEST_F(SignificantFit, LeavesOutASecondPoleOfAMode) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const DampedSinusoidFit fit =
        fit_significant(noisy(seed), {{19.9, 0.01}, {20.3, 0.02}, {40.0, 0.01}}, 2.0, {});
    EXPECT_THAT(frequencies(fit), testing::ElementsAre(testing::DoubleNear(20.0, 0.1),
                                                       testing::DoubleNear(40.0, 0.4)))
        << seed;
  }
}

TEST_F(SignificantFit, HasNoModesOfNoise) {
  DecayRecord record{.sample_rate = 200.0, .channels = {std::vector<double>(400, 0.0)}};
  add_noise(record, 1.0, 1);
  EXPECT_THAT(fit_significant(record, {{30.0, 0.01}, {60.0, 0.01}}, 2.0, {}).modes,
              testing::IsEmpty());
}

// The upper modes of a cello's D string and where the realization of a record of theirs had them,
// the highest 22 times as broad as it is: free to grow, its pole leaves the third with frequency
// and damping ratio seven deviations off under the third seed.
TEST(DampedSinusoidFit, APoleThatStartsTooBroadSpoilsNoOther) {
  const double turn = 2.0 * std::numbers::pi, duration = 1.51;
  const std::vector<double> found = {2399.448, 2556.241, 2714.795, 2872.999};
  const std::vector<double> lost = {20.76, 24.15, 44.19, 440.85};  // ζωT
  const std::vector<double> sizes = {0.06169, 0.05256, 0.02791, 0.00701};
  std::vector<DecayMode> truth;
  std::vector<DecayPole> start;
  for (std::size_t k = 0; k < 4; ++k) {
    const double n = static_cast<double>(k) + 16.0;
    const double frequency = n * 146.8 * std::sqrt(1.0 + 1.7e-4 * n * n);
    const double decay = 1.6 + 2.2e-3 * std::pow(n * std::numbers::pi / 0.69, 2);
    const double size = sizes[k], sign = k % 2 == 0 ? 1.0 : -1.0;
    truth.push_back({.pole = {frequency, decay / (turn * frequency)},
                     .amplitude = {{-size, -0.2 * size}, {sign * size, -0.1 * size}}});
    start.push_back({found[k], lost[k] / (duration * turn * found[k])});
  }
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    DecayRecord record = decay_of(truth, 2, 6400.0, 9664);
    add_noise(record, 0.003, seed);
    const DampedSinusoidFit fit = fit_damped_sinusoids(record, start);
    ASSERT_TRUE(fit.converged) << seed;
    for (std::size_t k = 0; k < 4; ++k) {
      const DecayMode& mode = fit.modes[k];
      // Of 40 standard normal numbers the largest is below 4 with 99.7 %.
      EXPECT_NEAR(mode.pole.frequency, truth[k].pole.frequency, 4.0 * mode.deviation.frequency);
      EXPECT_NEAR(mode.pole.damping_ratio, truth[k].pole.damping_ratio,
                  4.0 * mode.deviation.damping_ratio);
    }
  }
}

}  // namespace
}  // namespace modcal::significant_fit_test
