#include "libcalib/optimizers/staged/staged.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libcalib/calibration.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/optimizers/scoring.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::staged_test {
namespace {

class StagedSearch : public testing::Test {
 protected:
  StagedSearch() {
    options.parameters = {.law = true, .contact = true};
    options.objective = Choice<Objective>::of<JointLikelihood>(
        "joint_likelihood",
        {.left_noise = records.deviation[0], .right_noise = records.deviation[1]});
    start = bowed.truth;
    for (double& omega : start.basis.omega) omega *= 1.0005;
    start.contact += 2e-4;
  }

  BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.1);
  NoisyRecords records = noisy(bowed, 0.02, 3);
  CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);
  CalibrationOptions options;
  ModelPoint start;
};

Staged::Stage stage(double damping, const std::string& optimizer,
                    std::vector<std::string> free = {}) {
  Staged::Stage result{.damping = damping, .free = std::move(free)};
  result.optimizer.select(optimizer);
  return result;
}

TEST_F(StagedSearch, GoesThroughDampedRecordsToTheWholeOneByAnyOptimizer) {
  double value = 0.0;
  for (const std::string last : {"scoring", "ceres"}) {
    options.optimizer = Choice<Optimizer>::of<Staged>(
        "staged",
        {.stages = {stage(100.0, "scoring", {"f0", "B"}), stage(20.0, last), stage(0.0, last)}});
    const CalibrationResult found = calibrate(start, data, options);
    EXPECT_EQ(found.search.stages.size(), 3u);
    EXPECT_NEAR(found.model.contact, 0.0285, 6e-5) << last;
    EXPECT_NEAR(found.model.basis.omega[0] / bowed.truth.basis.omega[0], 1.0, 1e-4) << last;
    EXPECT_EQ(found.search.trace.back().value, found.search.value);
    // Both end within the tolerance of scoring, 1e-4 of a unit of minus the log likelihood; it may
    // pass the minimum by a little of its noise.
    if (value == 0.0) value = found.search.value;
    EXPECT_NEAR(found.search.value, value, 0.05) << last;
  }
}

TEST_F(StagedSearch, EndsWithinItsBudgetAndItsRanges) {
  options.parameters.ranges.contact = 1e-4;
  options.optimizer = Choice<Optimizer>::of<Staged>(
      "staged", {.stages = {stage(50.0, "scoring"), stage(0.0, "scoring")}});
  const CalibrationResult found = calibrate(start, data, options);
  EXPECT_LE(std::abs(found.model.contact - start.contact), 1.0001e-4);
  options.budget.evaluations = found.search.evaluations / 2;
  const CalibrationResult cut = calibrate(start, data, options);
  EXPECT_EQ(cut.search.stop, StopReason::kEvaluationBudget);
  EXPECT_LE(cut.search.evaluations, options.budget.evaluations);
  EXPECT_LE(cut.search.value, cut.search.initial_value);
}

TEST_F(StagedSearch, SaysWhatItCannotSearch) {
  const auto refusal = [&](const Staged::Stage& one) {
    options.optimizer = Choice<Optimizer>::of<Staged>("staged", {.stages = {one}});
    try {
      calibrate(start, data, options);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal(stage(0.0, "scoring", {"gain"})), testing::HasSubstr("frees \"gain\""));
  options.objective = Choice<Objective>("force_mismatch");
  EXPECT_THAT(refusal(stage(20.0, "ceres")), testing::HasSubstr("state damping: 0"));
  EXPECT_THAT(refusal(stage(0.0, "scoring")), testing::HasSubstr("needs the Fisher information"));
  EXPECT_EQ(refusal(stage(0.0, "ceres")), "");
}

}  // namespace
}  // namespace modcal::staged_test
