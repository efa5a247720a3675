#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "experiments/study/identification.hpp"
#include "libsim/base/error.hpp"

namespace modcal::scoring_test {
namespace {

Signal sine(double phase, double offset) {
  Signal signal{"f_c", "N", 1000.0, {}};
  for (int i = 0; i < 1000; ++i) {
    signal.samples.push_back(offset + std::sin(2.0 * std::numbers::pi * 10.0 * i / 1000.0 + phase));
  }
  return signal;
}

std::vector<WindowScore> score(const Signal& identified, const Signal& truth,
                               const ScoreOptions& options) {
  const std::optional<Signal> none;
  return score_force(ScoredForce(identified.samples),
                     {.truth = truth, .anti_aliased = none, .fundamental = 10.0}, options)
      .scores;
}

TEST(ScoreWindows, SeesPhaseAndNotTheStaticPart) {
  // Two whole periods of sines that differ by the phase p correlate as cos p, and the rms of their
  // difference over that of one is 2 sin(p/2).
  const auto scores = score(sine(0.3, 5.0), sine(0.0, -1.0), {.windows = {0.1, 0.5}});
  ASSERT_EQ(scores.size(), 2u);
  for (const WindowScore& score : scores) {
    EXPECT_NEAR(score.correlation, std::cos(0.3), 1e-12);
    EXPECT_NEAR(score.relative_rms_error, 2.0 * std::sin(0.15), 1e-12);
  }
  EXPECT_EQ(scores[1].start, 0.5);
}

// Two periods of 0.1 s at either end are left out: what is wrong there does not count.
TEST(ScoreWindows, LeavesTheEndsOutWithoutWindows) {
  Signal identified = sine(0.3, 0.0);
  for (std::size_t j = 0; j < 200; ++j) identified.samples[j] = identified.samples[999 - j] = 1e3;
  const auto scores = score(identified, sine(0.0, 0.0), {});
  ASSERT_EQ(scores.size(), 1u);
  EXPECT_NEAR(scores[0].start, 0.2, 1e-12);
  EXPECT_NEAR(scores[0].stop, 0.8, 1e-12);
  EXPECT_NEAR(scores[0].correlation, std::cos(0.3), 1e-12);
}

// Six periods have no middle part as long as both ends: all of the record.
TEST(ScoreWindows, TakesAllOfAShortRecord) {
  Signal short_one = sine(0.3, 0.0), truth = sine(0.0, 0.0);
  for (Signal* signal : {&short_one, &truth}) signal->samples.resize(600);
  const auto scores = score(short_one, truth, {});
  EXPECT_EQ(scores[0].start, 0.0);
  EXPECT_NEAR(scores[0].stop, 0.6, 1e-12);
}

TEST(ScoreWindows, CountsWhatTheBandHolds) {
  // An error of amplitude 1 is within 1.96 deviations of 0.25 where |sin| < 0.49: 2 asin(0.49)/π.
  Signal identified = sine(0.0, 3.0);
  for (std::size_t j = 0; j < 1000; ++j) {
    const double t = static_cast<double>(j) / 1000.0;
    identified.samples[j] += std::sin(2.0 * std::numbers::pi * 7.0 * t + 0.1);
  }
  const Signal truth = sine(0.0, 0.0);
  const std::optional<Signal> none;
  ScoredForce force(identified.samples);
  const ScoreReference reference{.truth = truth, .anti_aliased = none, .fundamental = 1.0};
  const ScoreOptions all{.windows = {0.0}, .periods = 1.0};
  EXPECT_TRUE(std::isnan(score_force(force, reference, all).scores[0].coverage));
  force.deviation = 0.25;
  EXPECT_NEAR(score_force(force, reference, all).scores[0].coverage,
              2.0 * std::asin(0.49) / std::numbers::pi, 0.02);
  std::vector<double> deviations(1000, 0.0);
  std::fill(deviations.begin() + 500, deviations.end(), 1.0);
  force.deviations = deviations;  // the second half holds all
  EXPECT_NEAR(score_force(force, reference, all).scores[0].coverage, 0.5, 0.01);
}

TEST(ScoreWindows, RefusesAWindowBeyondTheRecord) {
  EXPECT_THROW(score(sine(0, 0), sine(0, 0), {.windows = {0.9}}), InvalidInput);
  EXPECT_NO_THROW(score(sine(0, 0), sine(0, 0), {.windows = {0.8}}));
}

TEST(ScoreWhole, ComparesTheLongWindowBelowTheCut) {
  // A tone above the cut spoils the correlation and not the anti-aliased one.
  Signal identified = sine(0.0, 0.0);
  for (int i = 0; i < 1000; ++i) {
    identified.samples[static_cast<std::size_t>(i)] +=
        std::sin(2.0 * std::numbers::pi * 300.0 * i / 1000.0);
  }
  const Signal truth = sine(0.0, 0.0);
  const std::optional<Signal> smooth = truth;
  const ScoreReference reference{
      .truth = truth, .anti_aliased = smooth, .anti_alias_cut = 100.0, .fundamental = 10.0};
  const WindowScore whole =
      score_force(ScoredForce(identified.samples), reference, {.whole = {0.1, 0.9}}).whole;
  EXPECT_NEAR(whole.correlation, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(whole.anti_aliased, 1.0, 1e-12);
  EXPECT_TRUE(
      std::isnan(score_force(ScoredForce(identified.samples), reference, {}).whole.correlation));
  EXPECT_THROW(score_force(ScoredForce(identified.samples), reference, {.whole = {0.5, 0.1}}),
               InvalidInput);
  EXPECT_THROW(score_force(ScoredForce(identified.samples), reference, {.whole = {0.5, 1.1}}),
               InvalidInput);
}

// Where sampling has folded a tone back below the cut, the force before it was sampled counts.
TEST(ScoreWhole, TakesTheUnaliasedForceWhereThereIsOne) {
  const Signal truth = sine(0.0, 0.0);
  Signal identified = truth;
  for (int i = 0; i < 1000; ++i) {
    identified.samples[static_cast<std::size_t>(i)] +=
        std::sin(2.0 * std::numbers::pi * 40.0 * i / 1000.0);
  }
  const std::optional<Signal> smooth = truth;
  const ScoreReference reference{
      .truth = truth, .anti_aliased = smooth, .anti_alias_cut = 100.0, .fundamental = 10.0};
  const ScoreOptions options{.windows = {0.1}, .whole = {0.1, 0.9}};
  EXPECT_NEAR(score_force(ScoredForce(identified.samples), reference, options).whole.anti_aliased,
              std::sqrt(0.5), 1e-12);
  ScoredForce force(identified.samples);
  force.unaliased = truth.samples;
  const WindowScore whole = score_force(force, reference, options).whole;
  EXPECT_NEAR(whole.anti_aliased, 1.0, 1e-12);
  EXPECT_NEAR(whole.correlation, std::sqrt(0.5), 1e-12);
  const auto windows = score_force(force, reference, options).scores;
  EXPECT_NEAR(windows[0].anti_aliased, 1.0, 1e-12);
}

TEST(LowPassed, KeepsWhatIsBelowTheCutAtEveryStep) {
  const Signal signal = sine(0.4, 1.0);
  const auto kept = low_passed(signal.samples, 1000.0, 50.0, 4);
  ASSERT_EQ(kept.size(), 250u);
  for (std::size_t j = 0; j < kept.size(); ++j) EXPECT_NEAR(kept[j], signal.samples[4 * j], 1e-12);
}

}  // namespace
}  // namespace modcal::scoring_test
