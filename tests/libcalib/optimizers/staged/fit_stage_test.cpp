
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::fit_stage_test {
namespace {

using testing::ElementsAre;

std::vector<std::string> names_of(const std::vector<FitStage>& stages) {
  std::vector<std::string> names;
  for (const FitStage& stage : stages) names.push_back(stage.name);
  return names;
}

void expect_in_order(const ContinuationResult& fit) {
  std::size_t before = 0;
  for (const FitStage& stage : fit.stages) {
    EXPECT_GT(stage.evaluations, before) << stage.name;
    EXPECT_TRUE(std::isfinite(stage.objective)) << stage.name;
    before = stage.evaluations;
  }
  EXPECT_LE(before, fit.evaluations);
}

struct Stroke {
  ModelPoint start;
  CalibrationData data;
  ContinuationOptions options;
};

Stroke stroke(double gain = 1.0) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 0.25);
  NoisyRecords records = noisy(bowed, 0.02, 3);
  for (double& sample : records.reactions[1]) sample *= gain;
  return {
      bowed.truth,
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate),
      {.law_width = 2e-3,
       .left_noise = records.deviation[0],
       .right_noise = records.deviation[1],
       .restarts = 0}};
}

TEST(FitStage, AreThoseOfALawThatHolds) {
  const Stroke one = stroke();
  const ContinuationResult fit = calibrate_by_continuation(one.start, one.data, one.options);
  ASSERT_TRUE(fit.law.accepted);
  ASSERT_EQ(fit.moved_modes, 0u);
  EXPECT_THAT(names_of(fit.stages),
              ElementsAre("law, sigma = 200 1/s", "law, sigma = 100 1/s", "law, sigma = 50 1/s",
                          "law, sigma = 20 1/s", "law, whole record", "law, weighted bins",
                          "free, whole record", "free, weighted bins",
                          "free, prior as wide as the law's followers"));
  expect_in_order(fit);
  EXPECT_EQ(fit.stages[5].chi2, fit.law.chi2);
  EXPECT_EQ(fit.stages.back().chi2, fit.chi2);
  EXPECT_TRUE(std::isnan(fit.stages[7].chi2));
  // The same record before and after weights, which move the model within its noise: the law's χ²
  // is 2 Σ|e|² over the degrees of freedom both times.
  EXPECT_NEAR(fit.stages[4].chi2, fit.law.chi2, fit.chi2_deviation);
}

TEST(FitStage, CountRestartsAndTheFitWithMisfitForNoise) {
  Stroke wrong = stroke(1.1);
  wrong.options.restarts = 1;
  const ContinuationResult fit = calibrate_by_continuation(wrong.start, wrong.data, wrong.options);
  ASSERT_FALSE(fit.fits);
  expect_in_order(fit);
  const std::vector<std::string> names = names_of(fit.stages);
  EXPECT_THAT(names, testing::Contains("restart 1: law, whole record"));
  // Of the noise stated, whatever the stage took for noise.
  const auto chi2_of = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), "misfit for noise: " + name);
    return found == names.end() ? std::nan("")
                                : fit.stages[static_cast<std::size_t>(found - names.begin())].chi2;
  };
  EXPECT_DOUBLE_EQ(chi2_of("law, weighted bins"), fit.law.chi2);
  EXPECT_DOUBLE_EQ(chi2_of("free, prior as wide as the law's followers"), fit.chi2);
  // No mode is said to leave the law, which is not fitted once more.
  EXPECT_EQ(names.back(), "misfit for noise: free, prior as wide as the law's followers");
  for (const ModeVerdict& mode : fit.modes) EXPECT_EQ(mode.tie, LawTie::kFollows);
}

TEST(FitStage, OfSeveralRecordsNameThem) {
  const Stroke one = stroke();
  const std::vector<CalibrationData> two = {one.data, one.data};
  const ContinuationResult fit = calibrate_records(one.start, two, one.options);
  expect_in_order(fit);
  const std::vector<std::string> names = names_of(fit.stages);
  ASSERT_EQ(names.size(), 9u + 9u + 3u);
  EXPECT_EQ(names[9], "stroke 2: law, sigma = 200 1/s");
  EXPECT_EQ(names[18], "all records: free, weighted bins");
  EXPECT_EQ(names[19], "all records: free, prior as wide as the law's followers");
  EXPECT_EQ(names[20], "all records: law");
  EXPECT_EQ(fit.stages[19].chi2, fit.chi2);
  EXPECT_EQ(fit.stages[20].chi2, fit.law.chi2);
  EXPECT_EQ(fit.stages[20].evaluations + 1, fit.evaluations);  // the covariance of the law
}

}  // namespace
}  // namespace modcal::fit_stage_test
