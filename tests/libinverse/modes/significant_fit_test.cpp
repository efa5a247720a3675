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
        true, {});
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
        fit_significant(noisy(seed), {{19.9, 0.01}, {20.3, 0.02}, {40.0, 0.01}}, 2.0, true, {});
    EXPECT_THAT(frequencies(fit), testing::ElementsAre(testing::DoubleNear(20.0, 0.1),
                                                       testing::DoubleNear(40.0, 0.4)))
        << seed;
  }
}

// Poles of all of the truth within four deviations, of which 30 standard normal numbers have none
// beyond with 99.8 %, whether the start has them or not.
void expect_all(const DampedSinusoidFit& fit, const std::vector<DecayMode>& truth) {
  ASSERT_TRUE(fit.converged);
  ASSERT_EQ(fit.modes.size(), truth.size());
  for (const DecayMode& expected : truth) {
    const DecayMode* nearest = &fit.modes.front();
    const auto distance = [&](const DecayMode& mode) {
      return std::abs(mode.pole.exponent() - expected.pole.exponent());
    };
    for (const DecayMode& mode : fit.modes) {
      if (distance(mode) < distance(*nearest)) nearest = &mode;
    }
    EXPECT_NEAR(nearest->pole.frequency, expected.pole.frequency,
                4.0 * nearest->deviation.frequency);
    EXPECT_NEAR(nearest->pole.damping_ratio, expected.pole.damping_ratio,
                4.0 * nearest->deviation.damping_ratio);
  }
}

TEST_F(SignificantFit, FindsAModeThatTheStartLacks) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    expect_all(fit_significant(noisy(seed), {{20.0, 0.01}}, 2.0, true, {}), truth_);
  }
}

// Both behind one pole: half as wide apart as they are wide, 20 · .01 Hz, of one shape and not.
TEST_F(SignificantFit, FindsTheSecondPoleOfAMode) {
  for (const double sign : {1.0, -1.0}) {
    std::vector<DecayMode> truth = truth_;
    truth.push_back({.pole = {20.1, 0.012}, .amplitude = {{0.5, 0.0}, {sign * 0.2, 0.1}}});
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      DecayRecord record = decay_of(truth, 2, 200.0, 400);
      add_noise(record, 0.002, seed);
      const DampedSinusoidFit one =
          fit_damped_sinusoids(record, std::vector<DecayPole>{{20.0, 0.01}, {40.0, 0.01}});
      EXPECT_GT(one.modes[0].departure, least_departure(2, 2));
      const DampedSinusoidFit fit =
          fit_significant(record, {{20.0, 0.01}, {40.0, 0.01}}, 2.0, true, {});
      expect_all(fit, truth);
      for (const DecayMode& mode : fit.modes) EXPECT_LT(mode.departure, least_departure(3, 2));
    }
  }
}

// Noise that is a hundred times as strong below 25 Hz: deviations of the mode there are, too.
TEST_F(SignificantFit, HasDeviationsOfTheNoiseAboutTheMode) {
  const std::vector<DecayMode> truth = {
      {.pole = {10.0, 0.02}, .amplitude = {{1.0, 0.5}, {-0.3, 0.2}}},
      {.pole = {60.0, 0.02}, .amplitude = {{1.0, 0.0}, {0.0, 1.0}}}};
  double squares = 0.0;
  constexpr int kSeeds = 40;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    DecayRecord record = decay_of(truth, 2, 200.0, 1600);
    DecayRecord noise{.sample_rate = 200.0, .channels = {2, std::vector<double>(1600, 0.0)}};
    add_noise(noise, 0.02, seed);
    for (std::size_t c = 0; c < 2; ++c) {
      double slow = 0.0, slower = 0.0;
      for (std::size_t m = 0; m < 1600; ++m) {
        slow += 0.5 * (noise.channels[c][m] - slow);
        slower += 0.5 * (slow - slower);
        record.channels[c][m] += slower + 0.002 * noise.channels[c][m];
      }
    }
    const DampedSinusoidFit fit =
        fit_significant(record, {{10.0, 0.02}, {60.0, 0.02}}, 2.0, true, {});
    ASSERT_EQ(fit.modes.size(), 2u) << seed;
    squares += std::pow((fit.modes[0].pole.frequency - 10.0) / fit.modes[0].deviation.frequency, 2);
  }
  // The mean of 40 squared standard normal numbers is 1 ± .22.
  EXPECT_NEAR(squares / kSeeds, 1.0, 0.7);
}

// A click: its poles would start at half the rate, where no fit can.
TEST_F(SignificantFit, StartsNoPoleBeyondHalfTheRate) {
  DecayRecord record = noisy(1);
  for (std::size_t m = 0; m < 4; ++m) record.channels[0][m] += m % 2 == 0 ? 20.0 : -20.0;
  EXPECT_NO_THROW(fit_significant(record, {{20.0, 0.01}, {40.0, 0.01}}, 2.0, true, {}));
}

TEST_F(SignificantFit, HasNoModesOfNoise) {
  DecayRecord record{.sample_rate = 200.0, .channels = {std::vector<double>(400, 0.0)}};
  add_noise(record, 1.0, 1);
  EXPECT_THAT(fit_significant(record, {{30.0, 0.01}, {60.0, 0.01}}, 2.0, true, {}).modes,
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
