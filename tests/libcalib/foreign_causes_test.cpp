// What is wrong with a record that no part of the libraries has made is named, freed or refused.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/libcalib/foreign_record.hpp"

namespace modcal::foreign_record_test {
namespace {

// A tuning that drifts is found, to first order, and free in the fit that is reported.
TEST(ForeignCause, ItsTuningMayDrift) {
  constexpr double kDrift = 2e-4;
  const CalibrationResult result =
      calibrated(stroke({.drift = kDrift}, truth::Reactions::kTension), {});
  expect_right(result);
  ASSERT_EQ(result.continuation->freed.size(), 1u);
  const ScoreTest& freed = result.continuation->freed.front();
  EXPECT_EQ(freed.cause, "drift of the tuning");
  const double deviation = kDrift / std::sqrt(freed.statistic);
  // First order: of mode 40, whose width is 2ζ = 3e-3, a tenth.
  EXPECT_NEAR(freed.amplitude, kDrift, 4.0 * deviation + 0.1 * kDrift);
  EXPECT_GT(freed.shift, 1.0);
}

// A bow that wanders along the string by a millimeter is what the fit names first, and refuses: x_c
// is not one number.
TEST(ForeignCause, ItsContactMayMove) {
  const CalibrationResult result =
      calibrated(stroke({.wander = 1e-3}, truth::Reactions::kTension), {});
  EXPECT_FALSE(result.continuation->right);
  const ScoreTest* cause = first_cause(result.continuation->tests);
  ASSERT_NE(cause, nullptr);
  EXPECT_EQ(cause->cause, "contact that moves");
  EXPECT_TRUE(cause->refuses());
  EXPECT_FALSE(cause->remedy().empty());
}

TEST(ForeignCause, AStillContactIsNotSaidToMove) {
  const CalibrationResult result = calibrated(equal_sensors(), {});
  EXPECT_FALSE(test_of(result, "contact that moves").named());
}

// What a second polarization does to both ends alike cannot be told: the fit is refused by what it
// does to one of them.
TEST(ForeignCause, ASecondPolarizationIsNamed) {
  const CalibrationResult result =
      calibrated(stroke({.polarization = {0.1, 0.03}}, truth::Reactions::kTension), {});
  EXPECT_FALSE(result.continuation->right);
  EXPECT_TRUE(test_of(result, "second polarization").named());
  const ScoreTest* cause = first_cause(result.continuation->tests);
  ASSERT_NE(cause, nullptr);
  EXPECT_TRUE(cause->refuses());
  EXPECT_FALSE(cause->remedy().empty());
}

// Alike at both ends it moves all frequencies. What it is estimated to move them by, the deviations
// hold: of both amplitudes, a share of 2 % of 1.02, to first order.
TEST(ForeignCause, ASecondPolarizationAlikeAtBothEndsIsInTheDeviations) {
  constexpr double kShare = 0.02, kDetuning = 1e-3;
  const CalibrationResult result = calibrated(
      stroke({.polarization = {kShare, kShare}, .detuning = kDetuning}, truth::Reactions::kTension),
      {.noise = 5e-3});
  const ScoreTest& test = test_of(result, "second polarization");
  EXPECT_EQ(test.detail, "detuned by +0.1 %");
  // Both ends alike by ±3 % move f_n by that share of the detuning, less where the record tells it.
  EXPECT_GT(test.untold(9, 9), 0.0);
  EXPECT_LT(std::sqrt(test.untold(9, 9)), std::sqrt(2.0) * kPolarizationWidth * kDetuning);
  const double amplitude = std::sqrt(2.0) * kShare / (1.0 + kShare);
  EXPECT_NEAR(test.amplitude, amplitude, kFour * test.amplitude / std::sqrt(test.statistic));
  EXPECT_GT(test.statistic, 4.0 * kFour);
  EXPECT_LT(std::abs(error(result, "f0", kFundamental)), kFour);
  EXPECT_LT(frequency_errors(result).largest, kFour);
}

std::vector<double> frequencies_of(const truth::TruthRecord& record) {
  std::vector<double> frequencies;
  for (const auto& mode : record.modes) frequencies.push_back(mode.omega / (2.0 * M_PI));
  return frequencies;
}

// A bridge that noise hides moves f_1 and f_2 by 1.4e-4 off the law that all others follow, and no
// test sees it: the deviations hold what it may be.
TEST(ForeignCause, ABridgeThatNoiseHidesIsInTheDeviations) {
  const truth::TruthRecord record =
      stroke({.body_frequency = 430.0, .body_damping = 0.02, .bridge_mass = 0.2},
             truth::Reactions::kTension);
  const CalibrationResult result = calibrated(record, {.noise = 0.05});
  EXPECT_TRUE(result.continuation->right);
  EXPECT_LT(frequency_errors(result, frequencies_of(record)).largest, kFour);
  EXPECT_LT(std::abs(error(result, "x_c", kContact)), kFour);
  const double lowest = result.continuation->modes[0].deviation;
  const CalibrationResult rigid = calibrated(equal_sensors(), {.noise = 0.05});
  // What the same noise hides of a string with rigid ends is as large.
  EXPECT_GT(rigid.continuation->modes[0].deviation, 0.2 * lowest);
}

// What its body does to the record is taken out, and what is left follows the law of the string on
// rigid ends; the frequencies are those on the bridge.
TEST(ForeignCause, ABridgeThatMovesIsTakenOut) {
  const truth::TruthRecord record =
      stroke({.body_frequency = 350.0, .body_damping = 0.02, .bridge_mass = 0.05},
             truth::Reactions::kTension);
  const CalibrationResult result = calibrated(record, {.noise = 5e-3});
  const ContinuationResult& found = *result.continuation;
  EXPECT_TRUE(found.right) << found.chi2;
  ASSERT_FALSE(found.freed.empty());
  const ScoreTest& body = found.freed.front();
  EXPECT_EQ(body.cause, "bridge that moves");
  // Where its mode is and how heavy: a step of the search is 1.7 %.
  EXPECT_NEAR(body.place, 350.0, 0.035 * 350.0);
  EXPECT_NEAR(1.0 / body.amplitude, 0.05, 0.5 * 0.05);
  EXPECT_NE(body.detail.find(" Hz, of 0.0"), std::string::npos) << body.detail;
  EXPECT_GT(body.shift, kFour);
  EXPECT_LT(frequency_errors(result, frequencies_of(record)).largest, kFour);
  EXPECT_LT(std::abs(error(result, "x_c", kContact)), kFour);
  EXPECT_LT(std::abs(error(result, "f0", kFundamental)), kFour);
}

TEST(ForeignCause, ANonlinearSensorIsNamed) {
  truth::TruthRecord record = equal_sensors();
  double power = 0.0;
  for (const double r : record.r2) power += r * r / static_cast<double>(record.r2.size());
  for (double& r : record.r2) r *= 1.0 + 0.005 * r * r / power;
  const CalibrationResult result = calibrated(record, {});
  EXPECT_TRUE(test_of(result, "nonlinear sensor").named());
  EXPECT_FALSE(result.continuation->right);
}

// Of an equal record no test says anything, whatever the noise; and none is made of a simulation.
TEST(ForeignCause, NoCauseIsSeenWhereThereIsNone) {
  for (const double noise : {0.002, 0.05}) {
    const CalibrationResult result = calibrated(equal_sensors(), {.noise = noise});
    ASSERT_EQ(result.continuation->tests.size(), 6u);
    for (const ScoreTest& test : result.continuation->tests) {
      EXPECT_FALSE(test.named()) << test.cause << " " << test.log_p;
    }
    EXPECT_TRUE(result.continuation->freed.empty());
  }
}

}  // namespace
}  // namespace modcal::foreign_record_test
