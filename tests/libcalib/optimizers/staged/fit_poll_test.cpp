// A continuation ends within one evaluation of somebody asking.
#include "libcalib/optimizers/staged/fit_poll.hpp"

#include <gtest/gtest.h>

#include "libcalib/calibration.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal {
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

// Counts, and throws the `last`-th time it is asked.
struct Countdown {
  std::size_t last = 0, asked = 0;
  void operator()() {
    if (++asked == last) throw Interrupted();
  }
};

TEST_F(FitPollTest, IsAskedBeforeEveryEvaluation) {
  Countdown count;
  const ContinuationResult fit =
      calibrate_by_continuation(bowed.truth, data, options, std::ref(count));
  EXPECT_GT(fit.evaluations, 20u);
  EXPECT_GE(count.asked, fit.evaluations);
}

TEST_F(FitPollTest, EndsTheFitWhereverItIs) {
  Countdown count;
  calibrate_by_continuation(bowed.truth, data, options, std::ref(count));
  // First, in the ladder of the law, where frequencies are free, last.
  for (const std::size_t last :
       {std::size_t{1}, count.asked / 3, 2 * count.asked / 3, count.asked}) {
    Countdown end{.last = last};
    EXPECT_THROW(calibrate_by_continuation(bowed.truth, data, options, std::ref(end)), Interrupted);
    EXPECT_EQ(end.asked, last);
  }
}

TEST_F(FitPollTest, EndsTheFitOfAllRecordsToo) {
  const std::vector<CalibrationData> two = {data, data};
  Countdown count;
  const RecordsFit fit = calibrate_records(bowed.truth, two, options, {}, std::ref(count));
  std::size_t evaluations = fit.evaluations;
  for (const ContinuationResult& single : fit.single) evaluations += single.evaluations;
  EXPECT_GE(count.asked, evaluations);
  Countdown end{.last = count.asked - 3};
  EXPECT_THROW(calibrate_records(bowed.truth, two, options, {}, std::ref(end)), Interrupted);
  EXPECT_EQ(end.asked, count.asked - 3);
}

TEST_F(FitPollTest, IsTheClockOfACalibration) {
  CalibrationOptions calibration{.has_continuation = true, .continuation = options};
  calibration.parameters.law = calibration.parameters.contact = true;
  calibration.parameters.frequencies = "all";
  Countdown end{.last = 12};
  const SecondsClock clock = [&end] {
    end();
    return 0.0;
  };
  EXPECT_THROW(calibrate(bowed.truth, data, calibration, clock), Interrupted);
  EXPECT_EQ(end.asked, 12u);
}

}  // namespace
}  // namespace modcal
