// Properties of all optimizers, and what each promises on problems with known answers.
#include "libcalib/optimizer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/optimizers/grid.hpp"
#include "libcalib/optimizers/mode_by_mode.hpp"
#include "libcalib/optimizers/nlopt_optimizer.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal {
namespace {

using testing::HasSubstr;

NloptOptimizer nlopt_with(std::string_view algorithm, std::int64_t seed = 1) {
  return NloptOptimizer({.algorithm = std::string(algorithm), .seed = seed});
}

std::vector<std::shared_ptr<const Optimizer>> all_optimizers() {
  std::vector<std::shared_ptr<const Optimizer>> all;
  for (const auto& entry : Optimizer::registry()) all.push_back(entry.recipe()->make());
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    all.push_back(std::make_shared<NloptOptimizer>(nlopt_with(algorithm)));
  }
  all.push_back(std::make_shared<CeresOptimizer>(CeresOptimizer::Options{.strategy = "dogleg"}));
  return all;
}

TEST(Optimizer, NamesAreThoseOfTheRegistry) {
  for (const auto& entry : Optimizer::registry()) {
    EXPECT_EQ(entry.recipe()->make()->name(), entry.name);
  }
}

TEST(Optimizer, NeverExceedsAnyBudgetOfEvaluations) {
  for (const auto& optimizer : all_optimizers()) {
    for (const std::int64_t budget : {1, 2, 7, 60}) {
      const Rosenbrock function;
      try {
        const OptimizationResult result =
            optimizer->minimize(function, box(-1.2, 1.0, -2.0, 2.0), {.evaluations = budget});
        EXPECT_EQ(result.evaluations, function.calls) << optimizer->name();
        EXPECT_GE(result.evaluations, 1);
        EXPECT_LE(result.value, result.initial_value) << optimizer->name();
        EXPECT_EQ(result.value, function.value(result.x)) << optimizer->name();
        --function.calls;
      } catch (const InvalidInput& refusal) {
        EXPECT_THAT(refusal.what(), HasSubstr("budget allows"));  // the grid, before it starts
        EXPECT_EQ(function.calls, 0);
      }
      EXPECT_LE(function.calls, budget) << optimizer->name();
    }
  }
}

TEST(Optimizer, ReturnsTheObjectivesExceptionIntact) {
  for (const auto& optimizer : all_optimizers()) {
    for (const int at : {1, 2, 3, 5}) {
      const Throwing function(at);
      EXPECT_THROW(optimizer->minimize(function, box(1.0, 1.0, -5.0, 5.0), {}), Boom)
          << optimizer->name() << " at evaluation " << at;
      EXPECT_EQ(function.calls, at) << optimizer->name();
    }
  }
}

TEST(Optimizer, AThrowingClockInterruptsTheSearch) {
  for (const auto& optimizer : all_optimizers()) {
    const Rosenbrock function;
    const SecondsClock clock = [&] {
      if (function.calls >= 5) throw Interrupted();
      return 0.0;
    };
    EXPECT_THROW(optimizer->minimize(function, box(-1.2, 1.0, -2.0, 2.0), {}, clock), Interrupted)
        << optimizer->name();
  }
}

TEST(Optimizer, AnInfiniteValueIsNeverTheAnswer) {
  for (const auto& optimizer : all_optimizers()) {
    if (optimizer->needs().gradient || optimizer->needs().least_squares) continue;
    const ValueOnly function(2, [](std::span<const double> x) {
      return x[0] < 0.9 ? std::numeric_limits<double>::infinity() : x[0] + x[1] * x[1];
    });
    const auto result = optimizer->minimize(function, box(1.0, 1.0, -2.0, 2.0), {});
    EXPECT_LE(result.value, 2.0) << optimizer->name();
    EXPECT_GE(result.x[0], 0.9) << optimizer->name();
  }
}

TEST(Optimizer, StopsAtTheTarget) {
  for (const auto& optimizer : all_optimizers()) {
    // Scans of single variables do not look at the target: their values are parts of the objective.
    if (optimizer->name() == "mode_by_mode") continue;
    const Quadratic function;
    const OptimizationResult result =
        optimizer->minimize(function, box(1.0, 1.0, -5.0, 5.0, 5.0), {.target = 2.0});
    EXPECT_EQ(result.stop, StopReason::kTargetReached) << optimizer->name();
    EXPECT_LE(result.value, 2.0) << optimizer->name();
    EXPECT_EQ(result.evaluations, function.calls);
  }
}

TEST(Optimizer, TheSameRunGivesTheSameBits) {
  for (const auto& optimizer : all_optimizers()) {
    const Rosenbrock function;
    const auto run = [&] {
      return optimizer->minimize(function, box(-1.2, 1.0, -2.0, 2.0), {.evaluations = 2000});
    };
    const OptimizationResult first = run();
    const OptimizationResult second = run();
    EXPECT_EQ(first.x, second.x) << optimizer->name();
    EXPECT_EQ(first.evaluations, second.evaluations) << optimizer->name();
  }
}

TEST(Optimizer, ExplainsWhatTheObjectiveLacksBeforeTheFirstEvaluation) {
  int calls = 0;
  const ValueOnly function(2, [&](std::span<const double>) { return ++calls; });
  const CeresOptimizer ceres({});
  EXPECT_THAT(ceres.explain_unsatisfied(function), HasSubstr("residuals"));
  EXPECT_THAT(ceres.explain_unsatisfied(function), HasSubstr("grid, mode_by_mode, nlopt"));
  EXPECT_THAT(nlopt_with("LD_LBFGS").explain_unsatisfied(function), HasSubstr("gradient"));
  EXPECT_EQ(nlopt_with("LN_BOBYQA").explain_unsatisfied(function), "");
  EXPECT_THROW(ceres.minimize(function, box(0.0, 0.0, -1.0, 1.0), {}), InvalidInput);
  EXPECT_EQ(calls, 0);
}

TEST(CeresOptimizer, SolvesLeastSquaresToRounding) {
  for (const std::string strategy : {"levenberg_marquardt", "dogleg"}) {
    const CeresOptimizer optimizer({.strategy = strategy});
    const auto rosenbrock = optimizer.minimize(Rosenbrock(), box(-1.2, 1.0, -2.0, 2.0), {});
    // Residuals vanish at the optimum: the last Gauss–Newton steps are quadratic.
    EXPECT_NEAR(rosenbrock.x[0], 1.0, 1e-7) << strategy;
    EXPECT_NEAR(rosenbrock.x[1], 1.0, 1e-7) << strategy;
    const auto quadratic = optimizer.minimize(Quadratic(), box(0.0, 0.0, -5.0, 5.0), {});
    EXPECT_NEAR(quadratic.x[0], 3.0, 1e-7) << strategy;
    EXPECT_NEAR(quadratic.x[1], -1.0, 1e-7) << strategy;
    // The bound cuts the optimum off: x stops at 2, y is free.
    const auto bounded = optimizer.minimize(Quadratic(), box(0.0, 0.0, -2.0, 2.0), {});
    EXPECT_NEAR(bounded.x[0], 2.0, 1e-7) << strategy;
    EXPECT_NEAR(bounded.x[1], -1.0, 1e-6) << strategy;
  }
}

TEST(NloptOptimizer, GradientAlgorithmsSolveTheQuadraticAndRosenbrock) {
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    if (!algorithm.starts_with("LD_")) continue;
    const NloptOptimizer optimizer = nlopt_with(algorithm);
    const auto quadratic = optimizer.minimize(Quadratic(), box(0.0, 0.0, -5.0, 5.0), {});
    EXPECT_NEAR(quadratic.x[0], 3.0, 1e-6) << algorithm;
    EXPECT_NEAR(quadratic.x[1], -1.0, 1e-6) << algorithm;
    const auto rosenbrock = optimizer.minimize(Rosenbrock(), box(-1.2, 1.0, -2.0, 2.0), {});
    // The valley's curvature is about 0.4: 1e-4 in x are 2e-9 in the value.
    EXPECT_NEAR(rosenbrock.x[0], 1.0, 1e-4) << algorithm;
    EXPECT_EQ(quadratic.stop == StopReason::kNoProgress, false) << algorithm;
  }
}

TEST(NloptOptimizer, DerivativeFreeAlgorithmsSolveTheQuadratic) {
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    if (!algorithm.starts_with("LN_")) continue;
    const auto result = nlopt_with(algorithm).minimize(Quadratic(), box(0.0, 0.0, -5.0, 5.0),
                                                       {.evaluations = 5000});
    EXPECT_NEAR(result.x[0], 3.0, 1e-5) << algorithm;
    EXPECT_NEAR(result.x[1], -1.0, 1e-5) << algorithm;
  }
}

TEST(NloptOptimizer, OneVariableIsSolvedOrRefusedInWords) {
  const ValueOnly function(1, [](std::span<const double> x) { return x[0] * x[0]; });
  const std::vector<Variable> line = {{"x", "1", 0.5, -1.0, 2.0, 1.0}};
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    if (algorithm[1] == 'D') continue;
    try {
      const auto result = nlopt_with(algorithm).minimize(function, line, {.evaluations = 2000});
      EXPECT_NEAR(result.x[0], 0.0, 1e-2) << algorithm;
    } catch (const InvalidInput& refusal) {
      EXPECT_EQ(algorithm, "LN_NEWUOA_BOUND");
      EXPECT_THAT(refusal.what(), HasSubstr("LN_NEWUOA_BOUND refuses 1 variables"));
    }
  }
}

TEST(NloptOptimizer, GlobalAlgorithmsFindBraninsMinimum) {
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    if (!algorithm.starts_with("G")) continue;
    const auto result =
        nlopt_with(algorithm).minimize(Branin(), branin_box(), {.evaluations = 5000});
    // Global searches end near the optimum, not on it; the next-best valley is none: all three
    // minima are equal, and 1 % of the range of values (308) would be 3.
    EXPECT_NEAR(result.value, Branin::kMinimum, 0.02) << algorithm;
  }
}

TEST(NloptOptimizer, SeedsDecideWhatRandomAlgorithmsDo) {
  const auto run = [](std::int64_t seed) {
    return nlopt_with("GN_CRS2_LM", seed).minimize(Branin(), branin_box(), {.evaluations = 200}).x;
  };
  EXPECT_EQ(run(3), run(3));
  EXPECT_NE(run(3), run(4));
}

TEST(NloptOptimizer, RefusesAlgorithmsThatDoNotWork) {
  for (const auto* name : {"LD_LBFGS_NOCEDAL", "LN_NEWUOA", "LD_AUGLAG", "GD_STOGO",
                           "GN_ORIG_DIRECT", "GN_MLSL", "BOBYQA", ""}) {
    EXPECT_THROW(nlopt_with(name), InvalidInput) << name;
  }
}

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
}  // namespace modcal
