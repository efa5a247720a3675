#include "libcalib/identifiability/rms_interval.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::rms_interval_test {
namespace {

TEST(RmsInterval, HasTheQuantilesOfTables) {
  // χ²_50: 32.357 at 2.5 %, 71.420 at 97.5 %; χ²_1: 3.841 at 95 %, 0.00393 at 5 %.
  EXPECT_NEAR(rms_interval(50).low, std::sqrt(50.0 / 71.420), 1e-5);
  EXPECT_NEAR(rms_interval(50).high, std::sqrt(50.0 / 32.357), 1e-5);
  EXPECT_NEAR(rms_interval(1, 0.9).low, std::sqrt(1.0 / 3.8415), 1e-5);
  EXPECT_NEAR(rms_interval(1, 0.9).high, std::sqrt(1.0 / 0.0039321), 1e-2);
}

TEST(RmsInterval, HoldsTheTruthAsOftenAsItSays) {
  constexpr std::size_t kStudies = 4000, kDraws = 20;
  std::vector<double> draw(kStudies * kDraws);
  fill_standard_normal(StreamKey(3).with("interval"), draw);
  const RmsInterval interval = rms_interval(kDraws, 0.9);
  std::size_t held = 0;
  for (std::size_t i = 0; i < kStudies; ++i) {
    double square = 0.0;
    for (std::size_t j = 0; j < kDraws; ++j) square += draw[i * kDraws + j] * draw[i * kDraws + j];
    const double rms = std::sqrt(square / kDraws);
    if (rms * interval.low < 1.0 && 1.0 < rms * interval.high) ++held;
  }
  // 4000 studies: √(0.09/4000) = 0.0047; four of them.
  EXPECT_NEAR(static_cast<double>(held) / kStudies, 0.9, 0.019);
}

TEST(RmsInterval, RefusesNoDraws) {
  EXPECT_THROW(rms_interval(0), InvalidInput);
  EXPECT_THROW(rms_interval(10, 1.0), InvalidInput);
}

}  // namespace
}  // namespace modcal::rms_interval_test
