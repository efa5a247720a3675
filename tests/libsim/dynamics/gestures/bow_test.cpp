#include "libsim/dynamics/gestures/bow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"

namespace modcal::bow_test {
namespace {

Choice<Gesture> table(std::vector<double> times, std::vector<double> factors) {
  return Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{std::move(times), std::move(factors)});
}

TEST(Bow, IsSteadyByDefault) {
  const BowMotion motion = bow_motion(Bow{.position = 0.03}, 1.0);
  EXPECT_TRUE(motion.is_steady());
  EXPECT_EQ(motion.velocity.at(0.5), 0.1);
  EXPECT_EQ(motion.normal_force.at(0.5), 1.0);
}

TEST(Bow, GesturesMultiplyTheNominalValues) {
  Bow bow{.position = 0.03, .velocity = 0.2, .normal_force = 3.0};
  bow.velocity_gesture = Choice<Gesture>::of<RampGesture>(
      "ramp", RampGesture::Options{.from = -1.0, .to = 1.0, .start = 0.5, .duration = 1.0});
  bow.force_gesture = table({0.0, 1.0, 2.0}, {0.0, 2.0, 0.0});
  const BowMotion motion = bow_motion(bow, 2.0);
  EXPECT_FALSE(motion.is_steady());
  EXPECT_EQ(motion.velocity.at(0.0), -0.2);  // the bow is reversed,
  EXPECT_EQ(motion.velocity.at(1.0), 0.0);
  EXPECT_EQ(motion.velocity.at(2.0), 0.2);
  EXPECT_EQ(motion.normal_force.at(1.5), 3.0);
  EXPECT_EQ(motion.normal_force.at(2.0), 0.0);  // and lifted
}

TEST(Bow, ASineStaysWithinTheErrorOfItsPieces) {
  const SineGesture gesture({.mean = 0.5, .amplitude = 2.0, .frequency = 7.0, .phase = 0.3});
  const PiecewiseLinear factor = gesture.over(0.4);
  // Interpolation error of a piece h: (2πf)² h²/8 · amplitude, h = 1/(128 f).
  const double bound = 2.0 * std::pow(2.0 * std::numbers::pi / 128.0, 2) / 8.0;
  for (int i = 0; i <= 1081; ++i) {
    const double t = 0.00037 * i;
    EXPECT_NEAR(factor.at(t), 0.5 + 2.0 * std::sin(2.0 * std::numbers::pi * 7.0 * t + 0.3),
                bound * (1.0 + 1e-9));
  }
}

TEST(Bow, RefusesABowThatPulls) {
  Bow bow{.position = 0.03};
  bow.force_gesture = table({0.0, 1.0}, {1.0, -0.1});
  EXPECT_THROW(bow_motion(bow, 2.0), InvalidInput);
  EXPECT_THROW(bow_motion(Bow{.normal_force = -1.0}, 1.0), InvalidInput);
  EXPECT_THROW(bow_motion(Bow{.velocity = std::nan("")}, 1.0), InvalidInput);
}

TEST(GestureNoise, HasItsLevelAndABandLimit) {
  const GestureNoise noise{.present = true, .level = 0.1, .cutoff = 50.0, .seed = 3};
  const double duration = 100.0;
  const PiecewiseLinear factor = noise.factor(duration, "bow velocity");
  const double rate = 2000.0;
  double variance = 0.0, inside = 0.0, outside = 0.0;
  const auto count = static_cast<std::size_t>(duration * rate);
  // Power of single lines at 25 and 100 Hz, each the mean over stretches of 0.1 s.
  for (std::size_t start = 0; start < count; start += 200) {
    double re[2] = {}, im[2] = {};
    for (std::size_t k = start; k < start + 200; ++k) {
      const double t = static_cast<double>(k) / rate, value = factor.at(t) - 1.0;
      variance += value * value / static_cast<double>(count);
      for (int i = 0; i < 2; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i == 0 ? 25.0 : 100.0) * t;
        // Hann window: leakage from inside the band would hide the stopband.
        const double phase = 2.0 * std::numbers::pi * static_cast<double>(k - start) / 200.0;
        const double window = 1.0 - std::cos(phase);
        re[i] += window * value * std::cos(angle);
        im[i] += window * value * std::sin(angle);
      }
    }
    inside += re[0] * re[0] + im[0] * im[0];
    outside += re[1] * re[1] + im[1] * im[1];
  }
  // 10 000 independent draws: the variance is within 5·√(2/10⁴) = 7 % of 0.01, and the windowed
  // sinc and the straight pieces take away a few per cent.
  EXPECT_NEAR(variance, 0.01, 0.12 * 0.01);
  EXPECT_LT(outside, 1e-3 * inside);
}

TEST(GestureNoise, DependsOnSeedAndRoleAloneAndStartsTheSameInALongerRecord) {
  const GestureNoise noise{.present = true, .level = 0.1, .cutoff = 50.0, .seed = 3};
  const PiecewiseLinear one = noise.factor(1.0, "bow velocity");
  const PiecewiseLinear longer = noise.factor(3.0, "bow velocity");
  EXPECT_NE(one.at(0.3), noise.factor(1.0, "normal force").at(0.3));
  for (int i = 0; i < 100; ++i) EXPECT_EQ(one.at(0.01 * i), longer.at(0.01 * i));
  GestureNoise other = noise;
  other.seed = 4;
  EXPECT_NE(one.at(0.3), other.factor(1.0, "bow velocity").at(0.3));
  other.present = false;
  EXPECT_TRUE(other.factor(1.0, "bow velocity").is_constant());
}

}  // namespace
}  // namespace modcal::bow_test
