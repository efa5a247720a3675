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
