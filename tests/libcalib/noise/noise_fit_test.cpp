#include "libcalib/noise/noise_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::noise_fit_test {
namespace {

constexpr double kBand = 2.0 * std::numbers::pi * 10300.0;

// √k bins of a level: 1.4 % of a level from 10 000, of which neighboring knots share theirs; four
// of them and what the straight lines between knots miss.
TEST(NoiseFit, FindsSpectraAndCoherence) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  const NoiseFit found = fit_noise(
      ProjectedLikelihood(WhitenedRecord::of(with_colored_noise(bowed, 0.01, 1), 0.0, kBand)),
      bowed.truth);
  EXPECT_FALSE(found.misfit);
  ASSERT_GT(found.spectrum.knots.size(), 1u);
  const NoiseSpectrum truth = colored_spectrum();
  for (const double f : {800.0, 1600.0, 3200.0, 6400.0}) {
    SCOPED_TRACE(f);
    const NoiseCovariance is = found.spectrum.at(f), was = truth.at(f);
    EXPECT_NEAR(is.left / was.left, 1.0, 0.2);
    EXPECT_NEAR(is.right / was.right, 1.0, 0.2);
    EXPECT_NEAR(std::abs(is.mixed - was.mixed) / std::sqrt(was.left * was.right), 0.0, 0.15);
  }
}

// White noise and nine times its power about 5 kHz, 1.7 kHz wide: knots an octave apart take what
// they miss of it for a misfit. Straight lines between thirds of one miss a quarter of its top.
TEST(NoiseFit, FollowsAHillNarrowerThanAnOctave) {
  constexpr double kPole = 0.9, kTurns = 2.0 * std::numbers::pi * 5000.0 / 51200.0, kShare = 0.25;
  const BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  NoisyRecords records = noisy(bowed, 0.01, 1, false);
  for (std::size_t r = 0; r < 2; ++r) {
    std::vector<double> white(records.samples());
    fill_standard_normal(StreamKey(5).with(std::uint64_t{r}), white);
    double last = 0.0, before = 0.0;
    for (std::size_t j = 0; j < white.size(); ++j) {
      const double now =
          2.0 * kPole * std::cos(kTurns) * last - kPole * kPole * before + kShare * white[j];
      before = last, last = now;
      records.reactions[r][j] += records.deviation[r] * (white[j] + now);
    }
    remove_mean(records.reactions[r]);
  }
  const NoiseFit found =
      fit_noise(ProjectedLikelihood(WhitenedRecord::of(records, 0.0, kBand)), bowed.truth);
  ASSERT_FALSE(found.misfit);
  for (const double f : {1500.0, 3500.0, 5000.0, 7000.0, 9500.0}) {
    SCOPED_TRACE(f);
    const Complex delay = std::polar(1.0, -2.0 * std::numbers::pi * f / 51200.0);
    const double truth = std::norm(1.0 + kShare / (1.0 - 2.0 * kPole * std::cos(kTurns) * delay +
                                                   kPole * kPole * delay * delay));
    EXPECT_NEAR(found.spectrum.at(f).left / truth, 1.0, 0.3);
    EXPECT_NEAR(found.spectrum.at(f).right / truth, 1.0, 0.3);
  }
}

TEST(NoiseFit, OfWhiteNoiseKeepsTwoLevels) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  NoisyRecords records = noisy(bowed, 0.01, 1);
  records.deviation[1] *= 1.5;  // read too high
  const NoiseFit found =
      fit_noise(ProjectedLikelihood(WhitenedRecord::of(records, 0.0, kBand)), bowed.truth);
  EXPECT_FALSE(found.misfit);
  ASSERT_EQ(found.spectrum.knots.size(), 1u);
  EXPECT_NEAR(found.spectrum.knots[0].noise.left, 1.0, 0.06);
  EXPECT_NEAR(found.spectrum.knots[0].noise.right, 1.0 / 2.25, 0.06 / 2.25);
}

// What grows with the signal is not taken for noise.
TEST(NoiseFit, KnowsTheMisfitOfAWrongModel) {
  BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  const ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.01, 1), 0.0, kBand));
  bowed.truth.sensors.gain = 1.02;
  const NoiseFit found = fit_noise(likelihood, bowed.truth);
  EXPECT_TRUE(found.misfit);
  // By a third of some of the 10 300 bins, √(3/bins).
  EXPECT_GT(found.error, std::sqrt(3.0 / 10300.0));
  EXPECT_LT(found.error, std::sqrt(3.0 / 5000.0));
}

}  // namespace
}  // namespace modcal::noise_fit_test
