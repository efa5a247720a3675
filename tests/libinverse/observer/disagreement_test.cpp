#include "libinverse/observer/disagreement.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer::disagreement_test {
namespace {

constexpr double kSampleRate = 8000.0;
constexpr std::size_t kCount = 16000;

std::vector<double> draw(double rms, const char* name) {
  std::vector<double> samples(kCount);
  fill_standard_normal(StreamKey(7).with(name), samples);
  for (double& value : samples) value *= rms;
  return samples;
}

std::vector<double> sum(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t j = 0; j < a.size(); ++j) a[j] += b[j];
  return a;
}

double rms_between(const std::vector<double>& a, const std::vector<double>& b) {
  double squares = 0.0;
  for (std::size_t j = kCount / 10; j < kCount * 9 / 10; ++j) {
    squares += (a[j] - b[j]) * (a[j] - b[j]);
  }
  return std::sqrt(squares / (0.8 * kCount));
}

// A signal, a reference with white errors of variance v and an estimate with white ones of variance
// e, independent. What is found holds the factor 1.4 for errors that are not.
struct Case {
  explicit Case(double error, double noise)
      : truth(draw(1.0, "truth")),
        reference(sum(truth, draw(noise, "reference"))),
        estimate(sum(truth, draw(error, "estimate"))),
        variance(kCount / 2 + 1, noise * noise) {}
  Reference held() const { return {reference, variance, kSampleRate}; }
  std::vector<double> errors() const {
    return bin_errors(estimate, band_errors(estimate, held()), kSampleRate, true);
  }
  std::vector<double> truth, reference, estimate, variance;
};

TEST(BandErrors, AreWhatTheDifferenceHasAboveTheReferencesOwn) {
  for (const double error : {0.02, 0.1, 0.5}) {
    const Case c(error, 0.1);
    for (const BandError& band : band_errors(c.estimate, c.held())) {
      EXPECT_NEAR(band.square / 1.4, error * error, 4.0 * band.deviation)
          << error << " at " << band.lowest;
    }
    EXPECT_NEAR(std::sqrt(sample_square(c.errors(), kCount) / 1.4), error, 0.03);
  }
}

TEST(BandErrors, AreNoneWhereTheEstimateIsRight) {
  const Case c(0.0, 0.1);
  EXPECT_LT(std::sqrt(sample_square(c.errors(), kCount)), 0.02);
  EXPECT_GT(estimate_share(c.held(), c.errors()), 0.95);
}

TEST(Combined, IsNoWorseThanTheBetterOfBoth) {
  for (const double error : {0.0, 0.03, 0.1, 0.3, 3.0}) {
    const Case c(error, 0.1);
    const double better =
        std::min(rms_between(c.estimate, c.truth), rms_between(c.reference, c.truth));
    const auto both = combined(c.estimate, c.held(), c.errors(), true);
    // What is not known of e moves a right estimate by 2 % of the reference's error.
    EXPECT_LT(rms_between(both, c.truth), 1.05 * better + 0.01 * 0.1 + (error == 0.0 ? 0.02 : 0.0))
        << error;
  }
}

// Both rest on the same reactions: an error of a sensor may be one of the estimate as well,
// although the two agree.
TEST(CombinedErrors, HoldWhatBothMayBeOffBy) {
  const Case c(0.05, 0.1);
  Reference reference = c.held();
  const double apart = sample_square(combined_errors(reference, c.errors(), true), kCount);
  EXPECT_NEAR(apart, 0.01 * 0.0035 / 0.0135, 0.1 * apart);
  const std::vector<double> excess(kCount / 2 + 1, 0.09);
  reference.excess = excess;
  EXPECT_NEAR(sample_square(with_excess(c.errors(), reference), kCount), 0.09, 1e-3);
  const double w = 0.0035 / 0.0135;
  EXPECT_NEAR(sample_square(combined_errors(reference, c.errors(), true), kCount),
              (1.0 - w) * (1.0 - w) * 0.09 + w * w * 0.1, 4e-3);
  reference.band_limit = 0.25 * kSampleRate;
  EXPECT_NEAR(
      sample_square(with_excess(std::vector<double>(kCount / 2 + 1, 0.0), reference), kCount),
      0.045, 1e-4);
}

TEST(Combined, EndsAtTheBandLimitUnlessTheModelIsToGoBeyond) {
  const Case c(0.1, 0.1);
  Reference limited = c.held();
  limited.band_limit = 1000.0;
  const auto bands = band_errors(c.estimate, limited);
  EXPECT_LE(bands.back().highest, 1000.0);
  const auto errors = bin_errors(c.estimate, bands, kSampleRate, false);
  EXPECT_NEAR(standard_deviation(combined(c.estimate, limited, errors, false)),
              std::sqrt(0.25 * 1.005), 0.02);
  EXPECT_NEAR(standard_deviation(combined(c.estimate, limited, errors, true)), 1.0, 0.02);
  // Above the limit nothing tells: all of it may be wrong, or as much as below.
  EXPECT_GT(sample_square(errors, kCount), 0.7);
  EXPECT_LT(sample_square(bin_errors(c.estimate, bands, kSampleRate, true), kCount), 0.03);
}

TEST(BandErrors, RefuseVariancesOfAnotherLength) {
  Case c(0.1, 0.1);
  c.variance.pop_back();
  EXPECT_THROW(band_errors(c.estimate, c.held()), InvalidInput);
}

}  // namespace
}  // namespace modcal::observer::disagreement_test
