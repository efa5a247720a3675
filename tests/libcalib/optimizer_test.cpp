// What every optimizer owes, whatever its algorithm.
#include "libcalib/optimizer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>

#include "libcalib/optimizers/nlopt_optimizer.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/any_optimizer.hpp"

namespace modcal::optimizer_test {
namespace {

using testing::HasSubstr;

INSTANTIATE_TEST_SUITE_P(All, AnyOptimizer, testing::ValuesIn(optimizer_cases()), label_of);

bool needs_squares(const OptimizerCase& one) { return one.optimizer->needs().sum_of_squares(); }

/// Takes a value that is no sum of squares.
class OfAnyValue : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, OfAnyValue,
                         testing::ValuesIn(cases_where(std::not_fn(needs_squares))), label_of);

/// Goes where the values lead it, too.
class SearchOfAnyValue : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, SearchOfAnyValue,
                         testing::ValuesIn(cases_where([](const OptimizerCase& one) {
                           return !needs_squares(one) && one.way != Way::kSystematic;
                         })),
                         label_of);

class OfSquares : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, OfSquares, testing::ValuesIn(cases_where(needs_squares)), label_of);

/// Scans of single variables do not look at the target: their values are parts of the objective.
class TowardsATarget : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, TowardsATarget,
                         testing::ValuesIn(cases_where([](const OptimizerCase& one) {
                           return one.optimizer->name() != "mode_by_mode";
                         })),
                         label_of);

TEST(Optimizer, NamesAreThoseOfTheRegistryAndEveryOneIsTested) {
  const auto cases = optimizer_cases();
  for (const auto& entry : Optimizer::registry()) {
    EXPECT_EQ(entry.recipe()->make()->name(), entry.name);
    // The one that searches likelihoods alone: Scoring below.
    if (entry.name == "scoring") continue;
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const OptimizerCase& one) {
      return one.optimizer->name() == entry.name;
    })) << entry.name;
  }
}

TEST_P(AnyOptimizer, NeverExceedsAnyBudgetOfEvaluations) {
  for (const std::int64_t budget : {1, 2, 3, 7, 60, 500}) {
    const Rosenbrock function;
    const FunctionProblem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
    try {
      const OptimizationResult result = problem.minimize(optimizer(), {.evaluations = budget});
      EXPECT_EQ(result.evaluations, function.calls);
      EXPECT_GE(result.evaluations, 1);
      EXPECT_LE(result.value, result.initial_value);
      EXPECT_EQ(result.value, problem.value(result.x));
      --function.calls;
    } catch (const InvalidInput& refusal) {
      EXPECT_THAT(refusal.what(), HasSubstr("budget allows"));  // the grid, before it starts
      EXPECT_EQ(function.calls, 0);
    }
    EXPECT_LE(function.calls, budget);
  }
}

TEST_P(AnyOptimizer, StartsNoEvaluationAfterTheTimeIsUp) {
  const Rosenbrock function;
  const FunctionProblem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
  // Every evaluation takes a second of this clock.
  const SecondsClock clock = [&function] { return static_cast<double>(function.calls); };
  const OptimizationResult result = problem.minimize(optimizer(), {.seconds = 5.0}, clock);
  EXPECT_EQ(result.stop, StopReason::kTimeBudget);
  // A scan is one block of evaluations, the clock read before it, and one more values its answer.
  EXPECT_LE(function.calls, way() == Way::kSystematic ? 52 : 5);
}

TEST_P(AnyOptimizer, ReturnsTheObjectivesExceptionIntact) {
  for (const int at : {1, 2, 3, 5}) {
    const Throwing function(at);
    const FunctionProblem problem(function, box(1.0, 1.0, -5.0, 5.0), one_variable());
    EXPECT_THROW(problem.minimize(optimizer(), {}), Boom) << "at evaluation " << at;
    EXPECT_EQ(function.calls, at);
  }
}

// A likelihood of two variables whose information is its Hessian: one step of scoring ends at (1,
// 2).
class QuadraticLikelihood final : public ObjectiveFunction {
 public:
  std::string_view name() const override { return "quadratic_likelihood"; }
  std::size_t dimension() const override { return 2; }
  Capabilities capabilities() const override { return {.gradient = true, .information = true}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const double a = x[0] - 1.0, b = x[1] - 2.0;
    if (outputs.value) *outputs.value = a * a + a * b + 2.0 * b * b;
    if (outputs.gradient) {
      outputs.gradient[0] = 2.0 * a + b;
      outputs.gradient[1] = a + 4.0 * b;
    }
    if (outputs.information) *outputs.information = Eigen::Matrix2d{{2.0, 1.0}, {1.0, 4.0}};
    for (Eigen::MatrixXd* none : {outputs.noise, outputs.prior}) {
      if (none) *none = Eigen::MatrixXd::Zero(2, 2);
    }
  }
};

TEST(Scoring, FindsTheMaximumOfALikelihood) {
  Choice<Optimizer> choice{"scoring"};
  const OptimizationResult result =
      choice.make()->minimize(QuadraticLikelihood(), box(0.0, 0.0, -5.0, 5.0), {});
  // A Newton step of a quadratic is exact but for the ridge of 1e-12 on the scaled Hessian, whose
  // smallest eigenvalue is 1 - 1/sqrt(8) = 0.65.
  EXPECT_NEAR(result.x[0], 1.0, 1e-11);
  EXPECT_NEAR(result.x[1], 2.0, 1e-11);
}

TEST(Scoring, StaysInsideTheBounds) {
  Choice<Optimizer> choice{"scoring"};
  const OptimizationResult result =
      choice.make()->minimize(QuadraticLikelihood(), box(0.0, 0.0, -0.5, 0.5), {});
  EXPECT_LE(std::abs(result.x[0]), 0.5);
  EXPECT_LE(std::abs(result.x[1]), 0.5);
}

TEST_P(AnyOptimizer, AThrowingClockInterruptsTheSearch) {
  const Rosenbrock function;
  const SecondsClock clock = [&] {
    if (function.calls >= 5) throw Interrupted();
    return 0.0;
  };
  const FunctionProblem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
  EXPECT_THROW(problem.minimize(optimizer(), {}, clock), Interrupted);
}

TEST_P(OfSquares, SaysThatAValueIsNone) {
  const ValueOnly function(2, [](std::span<const double> x) { return x[0]; });
  EXPECT_NE(optimizer().explain_unsatisfied(function), "");
}

TEST_P(OfAnyValue, NotANumberIsARejectedStep) {
  const ValueOnly function(2, [](std::span<const double> x) {
    return x[0] < 0.9999 ? std::numeric_limits<double>::quiet_NaN() : x[0] + x[1] * x[1];
  });
  const FunctionProblem problem(function, box(1.0, 1.0, -2.0, 2.0), one_variable());
  const OptimizationResult result = problem.minimize(optimizer(), enough());
  EXPECT_NE(result.stop, StopReason::kNotFinite);
  EXPECT_TRUE(std::isfinite(result.value));
  EXPECT_GE(result.x[0], 0.9999);
}

/// The quadratic as residuals that are no numbers left of x = 0.9.
class HalfUndefined final : public LeastSquaresProblem {
  std::array<double, 2> residuals(double x, double y) const override {
    return {x < 0.9 ? std::numeric_limits<double>::quiet_NaN() : x, 2.0 * (y + 1.0)};
  }
  std::array<double, 4> jacobian(double /*x*/, double /*y*/) const override {
    return {1.0, 0.0, 0.0, 2.0};
  }
};

TEST_P(AnyOptimizer, ResidualsThatAreNoNumbersAreARejectedStep) {
  const HalfUndefined function;
  const FunctionProblem problem(function, box(1.0, 1.0, -5.0, 5.0), one_variable());
  const OptimizationResult result = problem.minimize(optimizer(), enough());
  EXPECT_NE(result.stop, StopReason::kNotFinite);
  EXPECT_TRUE(std::isfinite(result.value));
  EXPECT_GE(result.x[0], 0.9);
}

TEST_P(AnyOptimizer, NotANumberAtTheInitialPointEndsTheSearchAndIsReported) {
  const HalfUndefined function;
  const FunctionProblem problem(function, box(0.5, 1.0, -5.0, 5.0), one_variable());
  EXPECT_EQ(problem.minimize(optimizer(), {}).stop, StopReason::kNotFinite);
  EXPECT_EQ(function.calls, 1);
}

TEST_P(OfAnyValue, AnInfiniteValueIsNeverTheAnswer) {
  const ValueOnly function(2, [](std::span<const double> x) {
    return x[0] < 0.9 ? std::numeric_limits<double>::infinity() : x[0] + x[1] * x[1];
  });
  const FunctionProblem problem(function, box(1.0, 1.0, -2.0, 2.0), one_variable());
  const auto result = problem.minimize(optimizer(), enough());
  EXPECT_LE(result.value, 2.0);
  EXPECT_GE(result.x[0], 0.9);
}

TEST_P(TowardsATarget, StopsAtTheTarget) {
  const Quadratic function;
  const FunctionProblem problem(function, box(1.0, -1.0, -5.0, 5.0, 5.0), one_variable());
  const OptimizationResult result = problem.minimize(optimizer(), {.target = 0.5});
  EXPECT_EQ(result.stop, StopReason::kTargetReached);
  EXPECT_LE(result.value, 0.5);
  EXPECT_EQ(result.evaluations, function.calls);
}

TEST_P(AnyOptimizer, TheSameRunGivesTheSameBitsOnAnyThread) {
  const Rosenbrock function;
  const FunctionProblem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
  const auto run = [&] { return problem.minimize(optimizer(), {.evaluations = 2000}); };
  const OptimizationResult first = run();
  std::array<OptimizationResult, 2> others;
  {
    // The thread that has drawn random numbers before, and new ones at the same time.
    std::jthread one([&] { others[0] = run(); });
    std::jthread two([&] { others[1] = run(); });
  }
  for (const auto& other : {run(), others[0], others[1]}) {
    EXPECT_EQ(first.x, other.x);
    EXPECT_EQ(first.evaluations, other.evaluations);
    EXPECT_EQ(first.stop, other.stop);
  }
}

double bowl_outside(std::span<const double> x) {
  return std::pow(x[0] - 3.0, 2) + 4.0 * std::pow(x[1] + 1.0, 2);
}

TEST_P(OfAnyValue, RespectsTheBounds) {
  double least = 0.0, most = 0.0;
  const ValueOnly function(2, [&](std::span<const double> x) {
    for (const double value : x) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
    return bowl_outside(x);
  });
  const FunctionProblem problem(function, box(0.25, 0.25, -0.5, 0.5), one_variable());
  problem.minimize(optimizer(), {.evaluations = 3000});
  EXPECT_GE(least, -0.5);
  EXPECT_LE(most, 0.5);
}

TEST_P(SearchOfAnyValue, EndsInTheCornerWhereTheBoundsCutTheOptimumOff) {
  const ValueOnly function(2, bowl_outside);
  const FunctionProblem problem(function, box(0.25, 0.25, -0.5, 0.5), one_variable());
  const auto result = problem.minimize(optimizer(), {.evaluations = 3000});
  const double tolerance = way() == Way::kGlobal ? 1e-2 : 1e-6;
  EXPECT_NEAR(result.x[0], 0.5, tolerance);
  EXPECT_NEAR(one_variable() ? -0.5 : result.x[1], -0.5, tolerance);
}

TEST(Optimizer, ExplainsWhatTheObjectiveLacksBeforeTheFirstEvaluation) {
  int calls = 0;
  const ValueOnly function(2, [&](std::span<const double>) { return ++calls; });
  const CeresOptimizer ceres({});
  EXPECT_THAT(ceres.explain_unsatisfied(function), HasSubstr("needs residuals"));
  EXPECT_THAT(ceres.explain_unsatisfied(function),
              HasSubstr("ceres_line_search, grid, gsl, mode_by_mode, nlopt"));
  EXPECT_EQ(NloptOptimizer({.algorithm = "LN_BOBYQA"}).explain_unsatisfied(function), "");
  EXPECT_THROW(ceres.minimize(function, box(0.0, 0.0, -1.0, 1.0), {}), InvalidInput);
  const GslOptimizer brent({.algorithm = "brent"});
  EXPECT_THROW(brent.minimize(function, box(0.0, 0.0, -1.0, 1.0), {}), InvalidInput);
  EXPECT_EQ(calls, 0);
}

// The page states what the tables in the code state, row by row.
TEST(OptimizersPage, HoldsEveryOptimizerAndEveryAlgorithm) {
  std::ifstream file(std::string(MODCAL_DOCS) + "/optimizers.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  for (const auto& entry : Optimizer::registry()) {
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| `{}` |", entry.name)));
  }
  for (const auto name : GslOptimizer::algorithms()) {
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| `{}` |", name)));
  }
  for (const NloptAlgorithm& row : NloptOptimizer::listed()) {
    const std::string_view use = row.use == NloptUse::kRefused     ? "refused"
                                 : row.use == NloptUse::kInTheBox  ? "in the box"
                                 : row.use == NloptUse::kUnbounded ? "through the map"
                                                                   : "starts `local_algorithm`";
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| `{}` | {} | {} |", row.name, use, row.refusal)));
  }
}

}  // namespace
}  // namespace modcal::optimizer_test
