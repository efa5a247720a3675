#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "experiments/kinds/sweep/sweep.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "libsim/base/error.hpp"

namespace modcal::sweep_outcome_test {
namespace {

TEST(SweepOutcome, ComesBackBitForBit) {
  TaskOutcome outcome;
  outcome.sides.push_back({"1",
                           0.1,
                           ChoiceStatus::kChosen,
                           {{0.78, 0.79, 1.0 / 3.0, 5e-324}, {0.7, 0.71, -0.0, 1e308}}});
  outcome.sides.push_back({"joint",
                           std::numeric_limits<double>::infinity(),
                           ChoiceStatus::kNoInteriorMinimum,
                           {{0.0, 1.0, std::nan(""), 1.0}}});
  outcome.sides[0].misfit = 1.0 + 1e-15;
  const std::string text = report::json_line(outcome);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  const TaskOutcome again = read_outcome<TaskOutcome>(text);
  ASSERT_EQ(again.sides.size(), 2u);
  EXPECT_EQ(again.sides[0].side, "1");
  EXPECT_EQ(again.sides[1].side, "joint");
  EXPECT_EQ(again.sides[0].parameter, 0.1);
  EXPECT_EQ(again.sides[0].misfit, 1.0 + 1e-15);
  EXPECT_TRUE(std::isnan(again.sides[1].misfit));
  EXPECT_EQ(again.sides[0].scores[0].correlation, 1.0 / 3.0);
  EXPECT_EQ(again.sides[0].scores[0].relative_rms_error, 5e-324);
  EXPECT_EQ(again.sides[0].scores[0].stop, 0.79);
  EXPECT_TRUE(std::isnan(again.sides[0].scores[0].coverage));
  EXPECT_TRUE(std::signbit(again.sides[0].scores[1].correlation));
  EXPECT_EQ(again.sides[1].status, ChoiceStatus::kNoInteriorMinimum);
  EXPECT_TRUE(std::isinf(again.sides[1].parameter));
  EXPECT_TRUE(std::isnan(again.sides[1].scores[0].correlation));
  EXPECT_EQ(report::json_line(again), text);
}

TEST(SweepOutcome, KeepsTheReasonOfAFailure) {
  TaskOutcome outcome;
  outcome.failure = "line 1\n\"quoted\"";
  const std::string text = report::json_line(outcome);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_EQ(read_outcome<TaskOutcome>(text).failure, outcome.failure);
}

TEST(SweepOutcome, RefusesOtherTexts) {
  for (const char* text :
       {"", "{}", "[1]", R"({"sides": [{}]})",
        R"({"sides": [{"end": "left", "parameter": 1, "status": "x", "scores": []}]})"}) {
    EXPECT_THROW(read_outcome<TaskOutcome>(text), InvalidInput) << text;
  }
}

}  // namespace
}  // namespace modcal::sweep_outcome_test
