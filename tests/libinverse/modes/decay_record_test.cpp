#include "libinverse/modes/decay_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

}  // namespace
}  // namespace modcal::decay_record_test
