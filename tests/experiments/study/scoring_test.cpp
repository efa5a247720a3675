#include "experiments/study/scoring.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

Signal sine(double phase, double offset) {
  Signal signal{"f_c", "N", 1000.0, {}};
  for (int i = 0; i < 1000; ++i) {
    signal.samples.push_back(offset + std::sin(2.0 * std::numbers::pi * 10.0 * i / 1000.0 + phase));
  }
  return signal;
}

TEST(ScoreWindows, SeesPhaseAndNotTheStaticPart) {
  // Two whole periods of sines that differ by the phase p correlate as cos p, and the rms of their
  // difference over that of one is 2 sin(p/2).
  const auto scores = score_windows(sine(0.3, 5.0), sine(0.0, -1.0), {.windows = {0.1, 0.5}}, 10.0);
  ASSERT_EQ(scores.size(), 2u);
  for (const WindowScore& score : scores) {
    EXPECT_NEAR(score.correlation, std::cos(0.3), 1e-12);
    EXPECT_NEAR(score.relative_rms_error, 2.0 * std::sin(0.15), 1e-12);
  }
  EXPECT_EQ(scores[1].start, 0.5);
}

TEST(ScoreWindows, TakesTheWholeRecordWithoutWindows) {
  const auto scores = score_windows(sine(0.3, 0.0), sine(0.0, 0.0), {}, 10.0);
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_NEAR(scores[0].correlation, std::cos(0.3), 1e-12);
}

TEST(ScoreWindows, RefusesAWindowBeyondTheRecord) {
  EXPECT_THROW(score_windows(sine(0, 0), sine(0, 0), {.windows = {0.9}}, 10.0), InvalidInput);
  EXPECT_NO_THROW(score_windows(sine(0, 0), sine(0, 0), {.windows = {0.8}}, 10.0));
}

}  // namespace
}  // namespace modcal
