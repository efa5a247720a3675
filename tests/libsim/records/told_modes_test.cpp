#include "libsim/records/told_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/random.hpp"
#include "tests/refusal.hpp"

namespace modcal::told_modes_test {
namespace {

using testing::HasSubstr;

constexpr double kRate = 51200.0;
const StringModel kString{.fundamental = 294.0, .inharmonicity = 1.1e-4, .modes = 0};

// Lines at the modes up to number `top`, falling as 1/n, in white noise.
RecordedSignals record(std::int64_t top, double noise, std::size_t samples = 25600) {
  std::vector<double> x(samples);
  fill_uniform(StreamKey(7).with("told modes"), x);
  for (double& value : x) value = noise * std::sqrt(12.0) * (value - 0.5);
  for (std::int64_t n = 1; n <= top; ++n) {
    const double turn = 2.0 * std::numbers::pi / kRate *
                        stiff_string_frequency(294.0, 1.1e-4, static_cast<std::size_t>(n));
    for (std::size_t j = 0; j < samples; ++j) {
      x[j] += std::sin(turn * static_cast<double>(j)) / static_cast<double>(n);
    }
  }
  Signal signal{.quantity = "R2", .unit = "N", .sample_rate = kRate, .samples = std::move(x)};
  return {.sample_rate = kRate, .right = std::move(signal)};
}

TEST(ToldModes, AreThoseOfTheBand) {
  // 59 modes lie below 20.48 kHz.
  EXPECT_EQ(modes_below(kString, 0.4 * kRate), 59);
  const ToldModes told = told_modes(kString, record(80, 0.05));
  EXPECT_EQ(told.count, 59);
  EXPECT_THAT(told.text(), HasSubstr("59 modes taken (modes: auto): those of the stated law"));
}

TEST(ToldModes, StandOutOfTheNoise) {
  const ToldModes told = told_modes(kString, record(36, 0.05));
  EXPECT_EQ(told.count, 36);
  EXPECT_EQ(told.in_band, 59);
  EXPECT_THAT(told.text(), HasSubstr("36 modes taken (modes: auto): of the 59 of the stated law"));
}

TEST(ToldModes, AreTenAtLeastAndAllWhereTheNoiseIsUnknown) {
  EXPECT_EQ(told_modes(kString, record(0, 1.0)).count, 10);
  EXPECT_EQ(told_modes(kString, record(3, 0.0, 50)).count, 59);
}

TEST(ToldModes, AreSixtyAtMost) {
  StringModel string = kString;
  string.fundamental = 196.0;
  const ToldModes told = told_modes(string, record(59, 1e-4));
  EXPECT_EQ(told.count, 60);
  EXPECT_GT(told.standing_out, 60);
  EXPECT_THAT(told.text(), HasSubstr("that stand out of the noise the first"));
}

TEST(ToldModes, OfAStringTooHighOrTooLowAreRefused) {
  StringModel string = kString;
  for (const double fundamental : {15000.0, 1e-3}) {
    string.fundamental = fundamental;
    EXPECT_THAT(refusal_of([&] { told_modes(string, record(3, 0.1)); }), HasSubstr("state modes"));
  }
}

}  // namespace
}  // namespace modcal::told_modes_test
