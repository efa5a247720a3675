// Which searches of a repeated search are left out, and where the search then ends.
#include "libcalib/optimizers/settled_variables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/optimizers/systematic_search.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal::settled_variables_test {
namespace {

using testing::Each;

const auto kEverything = [](std::size_t) { return true; };
const auto kNothing = [](std::size_t) { return false; };

// One variable with a second beside it, steps of 0.1.
class History {
 public:
  void search(std::size_t i, std::size_t place, double moved_to) {
    settled_.searched(i, x_, {.place = place, .step = 0.1}, moved_to);
    x_[i] = moved_to;
  }
  void leave_out(double moved_to) {
    settled_.left_out(0, moved_to);
    x_[0] = moved_to;
  }
  bool is_settled(const std::function<bool(std::size_t)>& reaches) const {
    return settled_.is_settled(0, x_, reaches);
  }
  std::size_t expected_place() const { return settled_.expected_place(0); }

 private:
  std::vector<double> x_ = {1.0, 5.0};
  SettledVariables settled_{x_};
};

TEST(SettledVariables, AVariableThatGoesToAndFroIsSettledAndTakesTheAnswerBeforeTheLast) {
  History history;
  history.search(0, 25, 1.05);
  EXPECT_FALSE(history.is_settled(kEverything));  // one search tells of no return
  history.search(0, 24, 1.0);
  EXPECT_TRUE(history.is_settled(kEverything));
  EXPECT_EQ(history.expected_place(), 25u);
  history.leave_out(1.05);
  EXPECT_TRUE(history.is_settled(kEverything));
  EXPECT_EQ(history.expected_place(), 24u);
}

TEST(SettledVariables, AVariableThatStaysIsSettledAndOneThatDriftsIsNot) {
  History stays;
  stays.search(0, 25, 1.0);
  stays.search(0, 25, 1.0);
  EXPECT_TRUE(stays.is_settled(kEverything));
  EXPECT_EQ(stays.expected_place(), 25u);
  History drifts;
  drifts.search(0, 25, 1.05);
  drifts.search(0, 25, 1.1);
  EXPECT_FALSE(drifts.is_settled(kEverything));
  History leaps;  // returns, but from farther than its step: more than one minimum
  leaps.search(0, 30, 1.5);
  leaps.search(0, 20, 1.0);
  EXPECT_FALSE(leaps.is_settled(kEverything));
}

TEST(SettledVariables, AVariableThatReachesItWakesItByMoreThanAStep) {
  History history;
  history.search(1, 25, 5.0);
  history.search(0, 25, 1.05);
  history.search(0, 24, 1.0);
  history.search(1, 26, 5.1);
  EXPECT_TRUE(history.is_settled(kEverything));  // one step is not enough
  history.search(1, 26, 5.2);
  EXPECT_FALSE(history.is_settled(kEverything));
  EXPECT_TRUE(history.is_settled(kNothing));
  history.search(0, 25, 1.05);  // searched again, among the others as they are now
  EXPECT_TRUE(history.is_settled(kEverything));
}

std::vector<Variable> from_one(std::size_t count) {
  return std::vector<Variable>(count, Variable{"x", "1", 1.0, 0.5, 1.5, 0.06});
}

TEST(ModeByModeSkipping, EndsOnTheSameBitsWhereVariablesAreIndependent) {
  const ValueOnly function(3, [](std::span<const double> x) {
    return std::abs(x[0] - 1.1) + std::abs(x[1] - 0.95) + std::abs(x[2] - 1.02);
  });
  for (const std::int64_t candidates : {50, 61}) {
    ModeByMode::Options options{.candidates = candidates, .loops = 12};
    const auto whole = ModeByMode(options).minimize(function, from_one(3), {});
    options.skip_settled = true;
    const auto result = ModeByMode(options).minimize(function, from_one(3), {});
    EXPECT_EQ(result.x, whole.x);
    EXPECT_EQ(result.value, whole.value);
    EXPECT_EQ(result.stop, whole.stop);
    EXPECT_EQ(whole.left_out(), 0);
    EXPECT_THAT(whole.searched, Each(3));
    EXPECT_EQ(result.searched.size(), static_cast<std::size_t>(result.loops));
    EXPECT_EQ(result.searched.front(), 3);
    EXPECT_EQ(result.searched.back(), 3);
    EXPECT_EQ(result.evaluations, 2 + candidates * (3 * result.loops - result.left_out()));
    // 61 candidates have one in the middle: such a search ends as soon as nothing moves.
    EXPECT_EQ(result.stop,
              candidates == 61 ? StopReason::kConverged : StopReason::kSearchCompleted);
    // Four loops to the farthest minimum and two more until all have returned: six or so of twelve.
    if (candidates == 50) {
      EXPECT_GE(result.left_out(), 3 * 5);
    }
  }
}

// x_2 marches on, x_1 leaps when x_2 is past 1.2, x_0 follows x_1; each reaches the one before it.
class Chain final : public ObjectiveFunction {
 public:
  std::string_view name() const override { return "chain"; }
  std::size_t dimension() const override { return 3; }
  Capabilities capabilities() const override { return {}; }
  std::unique_ptr<CoordinateScanner> scanner(std::span<const double> x) const override {
    class Scanner final : public EvaluatingScanner {
     public:
      using EvaluatingScanner::EvaluatingScanner;
      bool reaches(std::size_t j, std::size_t i) const override { return j == i + 1; }
    };
    return std::make_unique<Scanner>(*this, x);
  }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const double leap = x[2] > 1.2 ? 1.1 : 1.0;
    *outputs.value =
        std::abs(x[0] - x[1]) + 3.0 * std::abs(x[1] - leap) + 10.0 * std::abs(x[2] - 1.4);
  }
};

TEST(ModeByModeSkipping, SearchesAVariableAgainWhenWhatReachesItMoves) {
  ModeByMode::Options options{.loops = 25};
  const auto whole = ModeByMode(options).minimize(Chain(), from_one(3), {});
  options.skip_settled = true;
  const auto result = ModeByMode(options).minimize(Chain(), from_one(3), {});
  EXPECT_NEAR(result.x[0], 1.1, 1e-3);  // half a step is 0.0007
  EXPECT_NEAR(result.x[1], 1.1, 1e-3);
  EXPECT_NEAR(result.x[2], 1.4, 1e-3);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(result.x[i], whole.x[i], 1.01 * 0.0612 / 49.0 * 1.4);
  // x_2 is past 1.2 after seven loops: x_0 rests before, follows x_1, and then all rest.
  EXPECT_EQ(result.searched[6], 2);
  EXPECT_EQ(result.searched[8], 3);
  EXPECT_EQ(result.searched[20], 0);
  ASSERT_EQ(result.scans.size(), 6u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(result.scans[3 + i].chosen, result.x[i]);
}

}  // namespace
}  // namespace modcal::settled_variables_test
