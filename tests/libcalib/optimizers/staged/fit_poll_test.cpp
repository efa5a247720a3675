// Stages end within one evaluation of somebody asking, and obey budgets and ranges.
#include <gtest/gtest.h>

#include <functional>

#include "libcalib/calibration.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/optimizers/staged/as_calibration.hpp"

namespace modcal::fit_poll_test {
namespace {

class FitPollTest : public testing::Test {
 protected:
  BowedCase bowed = bowed_case(0.03, 0.0, 0.1);
  NoisyRecords records = noisy(bowed, 0.02, 3);
  ContinuationOptions options{.law_width = 2e-3,
                              .left_noise = records.deviation[0],
                              .right_noise = records.deviation[1],
                              .restarts = 0};
  CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);
};

// Counts, and throws the `last`-th time it is read.
struct Countdown {
  std::size_t last = 0, asked = 0;
  double operator()() {
    if (++asked == last) throw Interrupted();
    return 0.0;
  }
};

TEST_F(FitPollTest, IsReadBeforeEveryEvaluation) {
  Countdown count;
  const CalibrationResult result =
      calibrate(bowed.truth, data, as_calibration(options), std::ref(count));
  EXPECT_GT(result.search.evaluations, 20);
  EXPECT_GE(count.asked, static_cast<std::size_t>(result.search.evaluations));
  EXPECT_EQ(static_cast<std::size_t>(result.search.evaluations), result.continuation->evaluations);
}

TEST_F(FitPollTest, EndsTheFitWhereverItIs) {
  Countdown count;
  calibrate(bowed.truth, data, as_calibration(options), std::ref(count));
  // First, in the ladder of the law, where frequencies are free, last.
  for (const std::size_t last :
       {std::size_t{1}, count.asked / 3, 2 * count.asked / 3, count.asked}) {
    Countdown end{.last = last};
    EXPECT_THROW(calibrate(bowed.truth, data, as_calibration(options), std::ref(end)), Interrupted);
    EXPECT_EQ(end.asked, last);
  }
}

TEST_F(FitPollTest, EndsTheFitOfAllRecordsToo) {
  const std::vector<CalibrationRecord> two = as_records({data, data});
  Countdown count;
  const CalibrationResult result =
      calibrate(bowed.truth, two, as_calibration(options), std::ref(count));
  EXPECT_GE(count.asked, static_cast<std::size_t>(result.search.evaluations));
  Countdown end{.last = count.asked - 3};
  EXPECT_THROW(calibrate(bowed.truth, two, as_calibration(options), std::ref(end)), Interrupted);
  EXPECT_EQ(end.asked, count.asked - 3);
}

TEST_F(FitPollTest, BudgetsEndTheStagesWithTheBestOfThem) {
  CalibrationOptions limited = as_calibration(options);
  const CalibrationResult whole = calibrate(bowed.truth, data, limited);
  limited.budget.evaluations = whole.search.evaluations / 2;
  ModelPoint start = bowed.truth;
  for (double& omega : start.basis.omega) omega *= 1.004;
  const CalibrationResult cut = calibrate(start, data, limited);
  EXPECT_EQ(cut.search.stop, StopReason::kEvaluationBudget);
  EXPECT_LE(cut.search.evaluations, limited.budget.evaluations);
  EXPECT_EQ(cut.continuation, nullptr);
  EXPECT_FALSE(cut.search.trace.empty());
  EXPECT_NEAR(cut.model.basis.omega[0] / bowed.truth.basis.omega[0], 1.0, 1e-3);
}

TEST_F(FitPollTest, RangesHoldInEveryStage) {
  CalibrationOptions narrow = as_calibration(options);
  narrow.parameters.ranges.contact = 1e-4;
  ModelPoint start = bowed.truth;
  start.contact = 0.031;  // the truth, 30 mm, is beyond the range
  const CalibrationResult result = calibrate(start, data, narrow);
  EXPECT_GE(result.model.contact, 0.031 - 1.0001e-4);
  EXPECT_LE(result.model.contact, 0.031 + 1.0001e-4);
  for (const CalibratedParameter& parameter : result.parameters) {
    if (parameter.name != "x_c") continue;
    EXPECT_TRUE(parameter.at_bound);
  }
}

}  // namespace
}  // namespace modcal::fit_poll_test
