#include "libinverse/modes/decay_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "libinverse/modes/tuning.hpp"

namespace modcal::decay_record_test {
namespace {

// λ = ω (−0.6 + 0.8 i) of ζ = 0.6.
TEST(DecayPole, OfAStronglyDampedModeHasItsDampedFrequency) {
  const DecayPole pole{.frequency = 1.0 / (2.0 * std::numbers::pi), .damping_ratio = 0.6};
  EXPECT_NEAR(pole.exponent().real(), -0.6, 1e-15);
  EXPECT_NEAR(pole.exponent().imag(), 0.8, 1e-15);
  const DecayPole back = DecayPole::of_exponent({-30.0, 40.0});
  EXPECT_NEAR(back.frequency, 50.0 / (2.0 * std::numbers::pi), 1e-14);
  EXPECT_NEAR(back.damping_ratio, 0.6, 1e-15);
}

// Passes to 1e-4 of the amplitude, stops everything above half the new rate by 80 dB.
TEST(Decimation, PassesItsBandAndStopsWhatIsAboveHalfTheNewRate) {
  constexpr double kRate = 48000.0, kHighest = 1000.0;
  const Decimation how = decimation_of(1 << 16, kRate, kHighest);
  ASSERT_EQ(how.stride, 18u);  // 48000/18 = 2667 > 2600 Hz
  const DecimatedDecay decay{
      .record = {}, .stride = how.stride, .taps = how.taps, .original_rate = kRate};
  const auto gain = [&](double frequency) {
    return std::abs(decay.gain({0.0, 2.0 * std::numbers::pi * frequency}));
  };
  for (int f = 0; f <= kHighest; f += 10) EXPECT_NEAR(gain(f), 1.0, 1e-4) << f;
  double f = 0.5 * how.rate;
  while (f <= 0.5 * kRate) {
    EXPECT_LT(gain(f), 1.1e-4) << f;
    f += 10.0;
  }
}

// Of noise of σ what is rounded adds q²/12; half a step leaves exp(−π²/2) of the excess.
TEST(RoundingLevel, IsOneWhereNoiseCoversTheSteps) {
  constexpr double kStep = 0.1;
  const double read = kStep * std::sqrt(0.25 + 1.0 / 12.0);
  const double excess = std::exp(-0.5 * std::numbers::pi * std::numbers::pi);
  EXPECT_NEAR(rounding_level(read, kStep), 1.0 + kRoundingExcess * excess, 1e-12);
  EXPECT_EQ(rounding_level(0.2 * kStep, kStep), 1.0 + kRoundingExcess);
  EXPECT_EQ(rounding_level(std::numeric_limits<double>::quiet_NaN(), kStep), 1.0 + kRoundingExcess);
  EXPECT_EQ(rounding_level(0.01, 0.0), 1.0);
}

}  // namespace
}  // namespace modcal::decay_record_test
