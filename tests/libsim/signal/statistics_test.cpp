#include "libsim/signal/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "libsim/base/error.hpp"

namespace modcal::statistics_test {
namespace {

const std::vector<double> kSample = {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0};

TEST(LargestMagnitude, PassesOverWhatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(largest_magnitude({}), 0.0);
  EXPECT_EQ(largest_magnitude(std::vector{1.0, -3.0, 2.0}), 3.0);
  EXPECT_EQ(largest_magnitude(std::vector{nan, 1.0, nan}), 1.0);
}

TEST(Moments, OfASampleWorkedByHand) {
  EXPECT_EQ(mean(kSample), 5.0);
  EXPECT_EQ(standard_deviation(kSample), 2.0);  // divisor n: 32/8
}

TEST(RemoveMean, LeavesTheRest) {
  std::vector<double> samples = kSample;
  remove_mean(samples);
  EXPECT_EQ(samples, (std::vector<double>{-3, -1, -1, -1, 0, 0, 2, 4}));
}

TEST(Correlation, IsThatOfASampleWorkedByHand) {
  // Deviations (−1, 0, 1) and (−1, 1, 0): covariance 1, variances 2 and 2.
  EXPECT_NEAR(correlation(std::vector{1.0, 2.0, 3.0}, std::vector{1.0, 3.0, 2.0}), 0.5, 1e-15);
}

TEST(Correlation, ForgetsScaleAndOffsetButNotSign) {
  std::vector<double> other = kSample;
  for (double& value : other) value = 3.0 - 1e-9 * value;
  // The offset of 3 leaves 1e-9 · 2 ± 3 · 1.1e-16: seven digits, squared in the error.
  EXPECT_NEAR(correlation(kSample, other), -1.0, 1e-12);
  EXPECT_NEAR(correlation(kSample, kSample), 1.0, 1e-15);
}

TEST(Correlation, OfAConstantIsNotANumber) {
  EXPECT_TRUE(std::isnan(correlation(kSample, std::vector<double>(8, 1.0))));
}

TEST(RelativeRmsError, IsRelativeToTheReferenceAndBlindToOffsets) {
  std::vector<double> other = kSample;
  for (double& value : other) value = 1.1 * value + 7.0;
  EXPECT_NEAR(relative_rms_error(other, kSample), 0.1, 1e-14);
  EXPECT_NEAR(relative_rms_error(kSample, other), 0.1 / 1.1, 1e-14);
  EXPECT_TRUE(std::isnan(relative_rms_error(kSample, std::vector<double>(8, 1.0))));
}

TEST(Comparisons, RefuseDifferentLengthsAndEmptySequences) {
  const std::vector<double> shorter(7, 1.0);
  EXPECT_THROW(correlation(kSample, shorter), InvalidInput);
  EXPECT_THROW(relative_rms_error(kSample, shorter), InvalidInput);
  EXPECT_THROW(correlation({}, {}), InvalidInput);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  const std::vector<double> values = {40.0, 10.0, 30.0, 20.0};
  EXPECT_EQ(quantile(values, 0.0), 10.0);
  EXPECT_EQ(quantile(values, 0.5), 25.0);
  EXPECT_NEAR(quantile(values, 0.1), 13.0, 1e-13);
  EXPECT_EQ(quantile(values, 1.0), 40.0);
  EXPECT_EQ(quantile({5.0}, 0.3), 5.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace modcal::statistics_test
