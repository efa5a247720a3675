// Properties of all optimizers, and what each promises on problems with known answers.
#include "libcalib/optimizer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlopt.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <numbers>
#include <thread>

#include "libcalib/optimizers/nlopt_algorithms.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/optimizer_cases.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal {
namespace {

using testing::HasSubstr;

NloptOptimizer nlopt_with(std::string_view algorithm, std::int64_t seed = 1) {
  return NloptOptimizer({.algorithm = std::string(algorithm), .seed = seed});
}

// What every optimizer owes, whatever its algorithm.
class AnyOptimizer : public testing::TestWithParam<OptimizerCase> {
 protected:
  const Optimizer& optimizer() const { return *GetParam().optimizer; }
  Way way() const { return GetParam().way; }
  bool one_variable() const { return way() == Way::kLine; }
  // MLSL's own work grows with the square of its evaluations.
  Budget enough() const {
    return {.evaluations = GetParam().label.find("MLSL") < 20 ? 2000 : 20000};
  }
};

INSTANTIATE_TEST_SUITE_P(All, AnyOptimizer, testing::ValuesIn(optimizer_cases()),
                         [](const auto& parameter) { return parameter.param.label; });

/// The first variable of a function of two, the other at rest.
class FirstVariable final : public ObjectiveFunction {
 public:
  FirstVariable(const ObjectiveFunction& function, double rest)
      : function_(function), rest_(rest) {}
  std::string_view name() const override { return "first_variable"; }
  std::size_t dimension() const override { return 1; }
  Capabilities capabilities() const override { return {}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    if (outputs.value) *outputs.value = function_.value(std::array{x[0], rest_});
  }
  const ObjectiveFunction& function_;
  double rest_;
};

/// A function of two variables as an optimizer can take it: whole, or along the first variable.
class Problem {
 public:
  Problem(const ObjectiveFunction& function, std::vector<Variable> variables, bool line)
      : function_(function),
        line_(function, variables[1].initial),
        use_line_(line),
        variables_(std::move(variables)) {
    if (line) variables_.resize(1);
  }
  OptimizationResult minimize(const Optimizer& optimizer, const Budget& budget,
                              SecondsClock clock = steady_seconds()) const {
    const ObjectiveFunction& function = use_line_ ? line_ : function_;
    return optimizer.minimize(function, variables_, budget, std::move(clock));
  }
  double value(std::span<const double> x) const {
    return use_line_ ? line_.value(x) : function_.value(x);
  }

 private:
  const ObjectiveFunction& function_;
  FirstVariable line_;
  bool use_line_;
  std::vector<Variable> variables_;
};

TEST(Optimizer, NamesAreThoseOfTheRegistryAndEveryOneIsTested) {
  const auto cases = optimizer_cases();
  for (const auto& entry : Optimizer::registry()) {
    EXPECT_EQ(entry.recipe()->make()->name(), entry.name);
    EXPECT_TRUE(std::any_of(cases.begin(), cases.end(), [&](const OptimizerCase& one) {
      return one.optimizer->name() == entry.name;
    })) << entry.name;
  }
}

TEST_P(AnyOptimizer, NeverExceedsAnyBudgetOfEvaluations) {
  for (const std::int64_t budget : {1, 2, 3, 7, 60, 500}) {
    const Rosenbrock function;
    const Problem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
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
  const Problem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
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
    const Problem problem(function, box(1.0, 1.0, -5.0, 5.0), one_variable());
    EXPECT_THROW(problem.minimize(optimizer(), {}), Boom) << "at evaluation " << at;
    EXPECT_EQ(function.calls, at);
  }
}

TEST_P(AnyOptimizer, AThrowingClockInterruptsTheSearch) {
  const Rosenbrock function;
  const SecondsClock clock = [&] {
    if (function.calls >= 5) throw Interrupted();
    return 0.0;
  };
  const Problem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
  EXPECT_THROW(problem.minimize(optimizer(), {}, clock), Interrupted);
}

TEST_P(AnyOptimizer, NotANumberEndsTheSearchAndIsReported) {
  const ValueOnly function(2, [](std::span<const double> x) {
    return x[0] < 0.9999 ? std::numeric_limits<double>::quiet_NaN() : x[0] + x[1] * x[1];
  });
  if (optimizer().needs().sum_of_squares()) {
    EXPECT_NE(optimizer().explain_unsatisfied(function), "");
    return;
  }
  const Problem problem(function, box(1.0, 1.0, -2.0, 2.0), one_variable());
  const OptimizationResult result = problem.minimize(optimizer(), {});
  EXPECT_EQ(result.stop, StopReason::kNotFinite);
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

TEST_P(AnyOptimizer, ResidualsThatAreNoNumbersEndTheSearchAndAreReported) {
  const HalfUndefined function;
  const Problem problem(function, box(1.0, 1.0, -5.0, 5.0), one_variable());
  const OptimizationResult result = problem.minimize(optimizer(), {});
  EXPECT_EQ(result.stop, StopReason::kNotFinite);
  EXPECT_TRUE(std::isfinite(result.value));
  EXPECT_GE(result.x[0], 0.9);
}

TEST_P(AnyOptimizer, AnInfiniteValueIsNeverTheAnswer) {
  if (optimizer().needs().sum_of_squares()) return;
  const ValueOnly function(2, [](std::span<const double> x) {
    return x[0] < 0.9 ? std::numeric_limits<double>::infinity() : x[0] + x[1] * x[1];
  });
  const Problem problem(function, box(1.0, 1.0, -2.0, 2.0), one_variable());
  const auto result = problem.minimize(optimizer(), {});
  EXPECT_LE(result.value, 2.0);
  EXPECT_GE(result.x[0], 0.9);
}

TEST_P(AnyOptimizer, StopsAtTheTarget) {
  // Scans of single variables do not look at the target: their values are parts of the objective.
  if (optimizer().name() == "mode_by_mode") return;
  const Quadratic function;
  const Problem problem(function, box(1.0, -1.0, -5.0, 5.0, 5.0), one_variable());
  const OptimizationResult result = problem.minimize(optimizer(), {.target = 0.5});
  EXPECT_EQ(result.stop, StopReason::kTargetReached);
  EXPECT_LE(result.value, 0.5);
  EXPECT_EQ(result.evaluations, function.calls);
}

TEST_P(AnyOptimizer, TheSameRunGivesTheSameBitsOnAnyThread) {
  const Rosenbrock function;
  const Problem problem(function, box(-1.2, 1.0, -2.0, 2.0), one_variable());
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

TEST_P(AnyOptimizer, RespectsTheBounds) {
  double least = 0.0, most = 0.0;
  const ValueOnly function(2, [&](std::span<const double> x) {
    for (const double value : x) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
    return std::pow(x[0] - 3.0, 2) + 4.0 * std::pow(x[1] + 1.0, 2);
  });
  if (optimizer().needs().sum_of_squares()) return;
  const Problem problem(function, box(0.25, 0.25, -0.5, 0.5), one_variable());
  const auto result = problem.minimize(optimizer(), {.evaluations = 3000});
  EXPECT_GE(least, -0.5);
  EXPECT_LE(most, 0.5);
  if (way() == Way::kSystematic) return;
  // The bound cuts the optimum off at the corner (0.5, −0.5).
  const double tolerance = way() == Way::kGlobal ? 1e-2 : 1e-6;
  EXPECT_NEAR(result.x[0], 0.5, tolerance);
  EXPECT_NEAR(one_variable() ? -0.5 : result.x[1], -0.5, tolerance);
}

TEST_P(AnyOptimizer, AVariableMayStartOnItsBound) {
  if (way() == Way::kSystematic || one_variable()) return;
  const Quadratic function;
  const auto on_bound = optimizer().minimize(function, box(5.0, 0.0, -5.0, 5.0), enough());
  // That it gets away from the bound is what counts.
  const double tolerance = way() == Way::kGlobal ? 5e-2 : 1e-3;
  EXPECT_NEAR(on_bound.x[0], 3.0, tolerance);
}

// What is promised on the standard problems, by the way a minimum is approached.

TEST_P(AnyOptimizer, SolvesTheQuadratic) {
  if (way() == Way::kSystematic) return;
  const Quadratic function;
  const Problem problem(function, box(0.0, 0.0, -5.0, 5.0), one_variable());
  const auto result = problem.minimize(optimizer(), enough());
  // Values alone locate a minimum to the root of their rounding, about 1e-8 of the box; a global
  // search ends when its evaluations do.
  const double tolerance = way() == Way::kGlobal         ? 1e-2
                           : way() == Way::kLeastSquares ? 1e-8
                           : way() == Way::kGradient     ? 1e-6
                                                         : 1e-5;
  EXPECT_NEAR(result.x[0], 3.0, tolerance);
  EXPECT_NEAR(one_variable() ? -1.0 : result.x[1], -1.0, tolerance);
  EXPECT_NE(result.stop, StopReason::kNoProgress);
}

TEST_P(AnyOptimizer, SolvesRosenbrocksProblem) {
  if (way() != Way::kLeastSquares && way() != Way::kGradient) return;
  if (GetParam().label.ends_with("steepest_descent")) return;  // it never gets through the valley
  const auto result = optimizer().minimize(Rosenbrock(), box(-1.2, 1.0, -2.0, 2.0), {});
  // Residuals vanish at the optimum: Gauss–Newton steps are quadratic. Else the valley's curvature
  // is about 0.4: 1e-4 in x are 2e-9 in the value.
  const double tolerance = way() == Way::kLeastSquares ? 1e-7 : 1e-4;
  EXPECT_NEAR(result.x[0], 1.0, tolerance);
  EXPECT_NEAR(result.x[1], 1.0, 2.0 * tolerance);
}

TEST_P(AnyOptimizer, SolvesPowellsProblems) {
  if (way() != Way::kLeastSquares) return;
  const auto scaled = optimizer().minimize(
      PowellBadlyScaled(), {{{"x", "1", 0.0, -1.0, 1.0, 1.0}, {"y", "1", 1.0, 0.0, 20.0, 1.0}}},
      {});
  EXPECT_NEAR(scaled.x[0], 1.098159e-5, 1e-10);
  EXPECT_NEAR(scaled.x[1], 9.106147, 1e-4);
  std::vector<Variable> four;
  for (const double start : {3.0, -1.0, 0.0, 1.0}) four.push_back({"x", "1", start, -9.0, 9.0});
  const auto singular = optimizer().minimize(PowellSingular(), four, {});
  // Near the origin the value is about 5 x^4 and its slope 20 x^3, which passes the tolerance
  // 1e-10 at x = 2e-4, where the value is 5e-15.
  EXPECT_LE(singular.value, 1e-14);
  for (const double x : singular.x) EXPECT_NEAR(x, 0.0, 1e-3);
}

TEST_P(AnyOptimizer, FitsASumOfDampedSinusoids) {
  if (way() != Way::kLeastSquares && way() != Way::kGradient) return;
  if (GetParam().label.ends_with("steepest_descent")) return;
  const std::vector<Variable> variables = {{"omega_1", "rad/s", 11.7, 10.0, 14.0, 0.5},
                                           {"d_1", "1/s", 1.0, 0.1, 3.0, 0.5},
                                           {"omega_2", "rad/s", 19.4, 17.0, 21.0, 0.5},
                                           {"d_2", "1/s", 1.2, 0.1, 3.0, 0.5}};
  const auto result = optimizer().minimize(DampedSinusoids(), variables, {});
  const double tolerance = way() == Way::kLeastSquares ? 1e-7 : 1e-4;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(result.x[i], DampedSinusoids::kTruth[i], tolerance) << variables[i].name;
  }
}

TEST_P(AnyOptimizer, FindsBraninsMinimum) {
  if (way() != Way::kGlobal) return;
  const auto result = optimizer().minimize(Branin(), branin_box(), {.evaluations = 5000});
  // Global searches end near the optimum, not on it; all three minima are equal, and 1 % of the
  // range of values (308) would be 3.
  EXPECT_NEAR(result.value, Branin::kMinimum, 0.02);
}

// Slopes that the objective does not give.

TEST_P(AnyOptimizer, FormsMissingSlopesByDifferences) {
  const bool least_squares = way() == Way::kLeastSquares;
  if (!least_squares && way() != Way::kGradient) return;
  const Quadratic quadratic;
  const Without function(quadratic, {.residuals = least_squares});
  const auto result = optimizer().minimize(function, box(0.0, 0.0, -5.0, 5.0), {});
  EXPECT_EQ(result.evaluations, quadratic.calls);
  EXPECT_GT(result.difference_evaluations, 0);
  EXPECT_NEAR(result.x[0], 3.0, 1e-6);
  EXPECT_NEAR(result.x[1], -1.0, 1e-6);
}

TEST(Optimizer, ExplainsWhatTheObjectiveLacksBeforeTheFirstEvaluation) {
  int calls = 0;
  const ValueOnly function(2, [&](std::span<const double>) { return ++calls; });
  const CeresOptimizer ceres({});
  EXPECT_THAT(ceres.explain_unsatisfied(function), HasSubstr("needs residuals"));
  EXPECT_THAT(ceres.explain_unsatisfied(function),
              HasSubstr("ceres_line_search, grid, gsl, mode_by_mode, nlopt"));
  EXPECT_EQ(nlopt_with("LN_BOBYQA").explain_unsatisfied(function), "");
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
  for (const NloptAlgorithm& row : nlopt_algorithms()) {
    const std::string_view use = row.use == NloptUse::kRefused     ? "refused"
                                 : row.use == NloptUse::kInTheBox  ? "in the box"
                                 : row.use == NloptUse::kUnbounded ? "through the map"
                                                                   : "starts `local_algorithm`";
    EXPECT_THAT(page, HasSubstr(fmt::format("\n| `{}` | {} | {} |", row.name, use, row.refusal)));
  }
}

TEST(GslOptimizer, BrentFindsTheMinimumOfACosine) {
  const ValueOnly function(1, [](std::span<const double> x) { return std::cos(x[0]); });
  const std::vector<Variable> line = {{"x", "rad", 2.0, 0.0, 6.0, 1.0}};
  for (const std::string algorithm : {"brent", "golden_section", "quad_golden"}) {
    const auto result = GslOptimizer({.algorithm = algorithm}).minimize(function, line, {});
    // cos is flat to rounding within √(2ε) = 2e-8 of π.
    EXPECT_NEAR(result.x[0], std::numbers::pi, 1e-7) << algorithm;
    EXPECT_LT(result.evaluations, 80) << algorithm;
  }
}

TEST(GslOptimizer, RefusesUnknownAlgorithmsAndTooFewResiduals) {
  EXPECT_THROW(GslOptimizer({.algorithm = "simplex"}), InvalidInput);
  EXPECT_THROW(GslOptimizer({.initial_step = 0.0}), InvalidInput);
}

TEST(NloptOptimizer, OneVariableIsSolvedOrRefusedInWords) {
  const ValueOnly function(1, [](std::span<const double> x) { return x[0] * x[0]; });
  const std::vector<Variable> line = {{"x", "1", 0.5, -1.0, 2.0, 1.0}};
  for (const auto algorithm : NloptOptimizer::algorithms()) {
    try {
      const auto result = nlopt_with(algorithm).minimize(function, line, {.evaluations = 2000});
      EXPECT_NEAR(result.x[0], 0.0, 1e-2) << algorithm;
    } catch (const InvalidInput& refusal) {
      EXPECT_THAT(refusal.what(), HasSubstr("refuses 1 variables")) << algorithm;
      EXPECT_TRUE(algorithm.starts_with("LN_NEWUOA")) << algorithm;
    }
  }
}

TEST(NloptOptimizer, SeedsDecideWhatRandomAlgorithmsDo) {
  const auto run = [](std::int64_t seed) {
    return nlopt_with("GN_CRS2_LM", seed).minimize(Branin(), branin_box(), {.evaluations = 200}).x;
  };
  EXPECT_EQ(run(3), run(3));
  EXPECT_NE(run(3), run(4));
}

TEST(NloptOptimizer, EveryAlgorithmNloptListsIsUsedOrRefusedWithAReason) {
  for (int i = 0; i < NLOPT_NUM_ALGORITHMS; ++i) {
    const char* name = nlopt_algorithm_to_string(static_cast<nlopt_algorithm>(i));
    const NloptAlgorithm* row = find_nlopt_algorithm(name);
    ASSERT_NE(row, nullptr) << name;
    if (row->use != NloptUse::kRefused) {
      EXPECT_NO_THROW(nlopt_with(name)) << name;
      continue;
    }
    try {
      nlopt_with(name);
      FAIL() << name;
    } catch (const InvalidInput& refusal) {
      EXPECT_THAT(refusal.what(), HasSubstr(std::string(row->refusal)));
    }
  }
  EXPECT_EQ(nlopt_algorithms().size(), static_cast<std::size_t>(NLOPT_NUM_ALGORITHMS));
  EXPECT_THROW(nlopt_with("BOBYQA"), InvalidInput);
  EXPECT_THROW(nlopt_with(""), InvalidInput);
}

TEST(NloptOptimizer, LocalAlgorithmsGoWithMlslAlone) {
  const NloptOptimizer mlsl({.algorithm = "GN_MLSL", .local_algorithm = "LN_COBYLA"});
  EXPECT_NEAR(mlsl.minimize(Branin(), branin_box(), {.evaluations = 2000}).value, Branin::kMinimum,
              1e-6);
  using Options = NloptOptimizer::Options;
  for (const Options& wrong : {Options{.algorithm = "LN_BOBYQA", .local_algorithm = "LN_COBYLA"},
                               Options{.algorithm = "GN_MLSL", .local_algorithm = "LD_LBFGS"},
                               Options{.algorithm = "GN_MLSL", .local_algorithm = "GN_DIRECT"}}) {
    EXPECT_THROW(NloptOptimizer{wrong}, InvalidInput);
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
