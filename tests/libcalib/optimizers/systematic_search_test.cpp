// The optimizers that lay their points out beforehand: grid and mode by mode.
#include "libcalib/optimizers/systematic_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal::systematic_search_test {
namespace {

using testing::HasSubstr;

TEST(Grid, VisitsEveryPointOnceAndTakesTheBest) {
  std::vector<std::pair<double, double>> seen;
  const ValueOnly function(2, [&](std::span<const double> x) {
    seen.emplace_back(x[0], x[1]);
    return std::abs(x[0] - 0.5) + std::abs(x[1] + 1.0);
  });
  const auto result = Grid({.points = 5}).minimize(function, box(0.0, 0.0, -1.0, 1.0, 0.25), {});
  EXPECT_EQ(result.x, (std::vector<double>{0.5, -1.0}));
  EXPECT_EQ(result.stop, StopReason::kSearchCompleted);
  ASSERT_EQ(seen.size(), 26u);
  EXPECT_EQ(seen.front(), std::make_pair(0.0, 0.0));  // the initial point
  seen.erase(seen.begin());
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::unique(seen.begin(), seen.end()), seen.end());
  EXPECT_EQ(seen.front(), std::make_pair(-1.0, -1.0));
  EXPECT_EQ(seen.back(), std::make_pair(1.0, 1.0));
}

TEST(Grid, KeepsTheValuesOfASingleVariable) {
  const ValueOnly function(1, [](std::span<const double> x) { return x[0] * x[0]; });
  const std::vector<Variable> line = {{"x", "1", 0.5, -1.0, 1.0, 0.1}};
  const auto result = Grid({.points = 5}).minimize(function, line, {});
  ASSERT_EQ(result.scans.size(), 1u);
  EXPECT_EQ(result.scans[0].candidates, (std::vector<double>{-1.0, -0.5, 0.0, 0.5, 1.0}));
  // Candidates go through the scaled variable: a rounding of 0.1·15 is 2e-16.
  EXPECT_NEAR(result.scans[0].values[1], 0.25, 1e-15);
  EXPECT_EQ(result.scans[0].chosen, 0.0);
  EXPECT_NEAR(result.x[0], 0.0, 1e-16);
}

TEST(Grid, RefusesMorePointsThanTheBudgetInWords) {
  const Quadratic function;
  try {
    Grid({.points = 1000}).minimize(function, box(0.0, 0.0, -1.0, 1.0), {});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("1e+06 points"));
    EXPECT_THAT(error.what(), HasSubstr("free fewer parameters"));
  }
  EXPECT_EQ(function.calls, 0);
  EXPECT_THROW(Grid({.points = 1}), InvalidInput);
}

TEST(ModeByMode, MovesEachVariableToTheBestOfItsCandidatesInEveryLoop) {
  // Separable: every loop reaches 3 % further until the minimum (1.1, 0.95) is met.
  const ValueOnly function(
      2, [](std::span<const double> x) { return std::abs(x[0] - 1.1) + std::abs(x[1] - 0.95); });
  const ModeByMode optimizer({.candidates = 61, .half_range = 0.03, .loops = 10});
  const auto result = optimizer.minimize(function, box(1.0, 1.0, 0.5, 1.5, 0.06), {});
  // Candidates are 0.1 % apart.
  EXPECT_NEAR(result.x[0], 1.1, 0.5e-3 * 1.1);
  EXPECT_NEAR(result.x[1], 0.95, 0.5e-3);
  EXPECT_EQ(result.evaluations, 2 + result.loops * 2 * 61);
  // 61 is odd: the current value is a candidate, so that a loop can move nothing.
  EXPECT_EQ(result.stop, StopReason::kConverged);
  ASSERT_EQ(result.scans.size(), 4u);
  EXPECT_EQ(result.scans[0].loop, 1);
  EXPECT_EQ(result.scans[0].center, 1.0);
  EXPECT_EQ(result.scans[0].candidates.front(), 0.97);
  EXPECT_EQ(result.scans[0].chosen, 1.03);
  EXPECT_EQ(result.scans[3].variable, 1u);
  EXPECT_EQ(result.scans[3].loop, result.loops);
  EXPECT_EQ(result.scans[3].chosen, result.x[1]);
}

TEST(ModeByMode, SpendsWhatIsLeftOfTheBudgetAndNeverMore) {
  // Budgets below, at and above the first scan's candidates and those of a loop.
  for (const std::int64_t budget : {1, 2, 3, 4, 20, 50, 51, 52, 60, 101, 102, 103, 120}) {
    const ValueOnly function(
        2, [](std::span<const double> x) { return std::abs(x[0] - 1.02) + std::abs(x[1] - 0.98); });
    std::int64_t calls = 0;
    const ValueOnly counted(2, [&](std::span<const double> x) {
      ++calls;
      return function.value(x);
    });
    const auto result = ModeByMode(ModeByMode::Options{})
                            .minimize(counted, box(1.0, 1.0, 0.5, 1.5), {.evaluations = budget});
    EXPECT_EQ(result.stop, StopReason::kEvaluationBudget) << budget;
    EXPECT_EQ(result.evaluations, calls) << budget;
    EXPECT_LE(calls, budget);
    // One for the initial point; less than two left compare nothing; one is kept for the answer.
    EXPECT_GE(calls, budget < 4 ? 1 : budget - 2) << budget;
    EXPECT_LE(result.value, result.initial_value) << budget;
    // Three candidates and more reach to both sides: 3 % of 1 either way, steps of 6 % / (n − 1).
    if (budget >= 20) {
      EXPECT_LT(result.value, 0.6 * result.initial_value) << budget;
    }
  }
}

TEST(ModeByMode, AScanCutShortKeepsTheCurrentValueWhereItIsBest) {
  const ValueOnly function(1, [](std::span<const double> x) { return std::abs(x[0] - 1.0); });
  const std::vector<Variable> line = {{"x", "1", 1.0, 0.5, 1.5, 0.1}};
  const auto result =
      ModeByMode(ModeByMode::Options{}).minimize(function, line, {.evaluations = 12});
  EXPECT_EQ(result.x, (std::vector<double>{1.0}));
  EXPECT_EQ(result.value, 0.0);
}

TEST(ModeByMode, StaysWithinBoundsAndRefusesAVariableThatStartsAtZero) {
  const ValueOnly function(2, [](std::span<const double> x) { return -x[0] - x[1]; });
  const ModeByMode optimizer(ModeByMode::Options{});
  const auto result = optimizer.minimize(function, box(1.0, 1.0, 0.9, 1.1), {});
  EXPECT_EQ(result.x, (std::vector<double>{1.1, 1.1}));
  EXPECT_THROW(optimizer.minimize(function, box(1.0, 0.0, -1.0, 1.0), {}), InvalidInput);
  EXPECT_THROW(ModeByMode({.candidates = 1}), InvalidInput);
  EXPECT_THROW(ModeByMode({.half_range = 1.0}), InvalidInput);
  EXPECT_THROW(ModeByMode({.loops = 0}), InvalidInput);
}

}  // namespace
}  // namespace modcal::systematic_search_test
