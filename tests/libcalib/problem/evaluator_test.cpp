#include "libcalib/problem/evaluator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal::evaluator_test {
namespace {

using Point = std::vector<double>;
using Trial = Evaluator::Trial;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Evaluator, ScalesVariablesGradientAndJacobian) {
  const Quadratic quadratic;
  // Start (1, 2), scale 0.5: z = (2, −2) is (2, 1).
  Evaluator evaluator(quadratic, box(1.0, 2.0, -10.0, 10.0, 0.5), {});
  EXPECT_EQ(evaluator.lower()[0], -22.0);
  EXPECT_EQ(evaluator.upper()[1], 16.0);
  double value = 0.0;
  double gradient[2], residuals[2], jacobian[4];
  evaluator.evaluate(Point{2.0, -2.0}, {&value, gradient, residuals, jacobian});
  EXPECT_EQ(value, 0.5 * (1.0 + 16.0));
  EXPECT_EQ(gradient[0], -1.0 * 0.5);
  EXPECT_EQ(gradient[1], 8.0 * 0.5);
  EXPECT_EQ(residuals[1], 4.0);
  EXPECT_EQ(jacobian[0], 0.5);
  EXPECT_EQ(jacobian[3], 1.0);
}

TEST(Evaluator, FormsMissingSlopesByDifferencesAndCountsThem) {
  const Rosenbrock full;
  const Without values(full, {});
  const Point z = {-1.2, 1.0};
  // The second variable sits on its bound.
  Evaluator exact(full, box(0.0, 0.0, -2.0, 1.0), {});
  Evaluator by_values(values, box(0.0, 0.0, -2.0, 1.0), {});
  double expected[2], gradient[2];
  exact.evaluate(z, {.gradient = expected});
  full.calls = 0;
  by_values.evaluate(z, {.gradient = gradient});
  EXPECT_EQ(full.calls, 5);
  const OptimizationResult result = by_values.finish(StopReason::kConverged);
  EXPECT_EQ(result.evaluations, 5);
  EXPECT_EQ(result.difference_evaluations, 4);
  // h = 6.1e-6·1.2: h²/6 times the third derivative, 1200·1.2, is 1e-8; rounding ε·12/h is 5e-10.
  EXPECT_NEAR(gradient[0], expected[0], 3e-8);
  // Quadratic in y: the one-sided rule is exact but for rounding, 8·ε·12/h.
  EXPECT_NEAR(gradient[1], expected[1], 1e-8);

  const Without residuals(full, {.residuals = true});
  Evaluator by_residuals(residuals, box(0.0, 0.0, -2.0, 1.0), {});
  double jacobian[4], exact_jacobian[4], r[2];
  exact.evaluate(z, {.residuals = r, .jacobian = exact_jacobian});
  by_residuals.evaluate(z, {.gradient = gradient, .jacobian = jacobian});
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(jacobian[k], exact_jacobian[k], 1e-8);
  EXPECT_NEAR(gradient[0], expected[0], 3e-8);

  const Without no_gradient(full, {.least_squares = true});
  Evaluator by_jacobian(no_gradient, box(0.0, 0.0, -2.0, 1.0), {});
  by_jacobian.evaluate(z, {.gradient = gradient});
  EXPECT_DOUBLE_EQ(gradient[0], expected[0]);
  EXPECT_EQ(by_jacobian.finish(StopReason::kConverged).evaluations, 1);
}

// (2, 1) of the quadratic from a start at (1, 2): slopes of a quadratic are exact but for rounding,
// ε·10/h of h = 6e-6·2.
TEST(Evaluator, GivesTheGradientOfWhatHasValuesAlone) {
  const Quadratic full;
  const Without values(full, {});
  const auto variables = box(1.0, 2.0, -10.0, 10.0, 0.5);
  const std::vector<double> gradient = gradient_at(values, variables, Point{2.0, 1.0});
  EXPECT_NEAR(gradient[0], -1.0, 1e-8);
  EXPECT_NEAR(gradient[1], 8.0, 1e-8);
  EXPECT_EQ(gradient_at(full, variables, Point{2.0, 1.0}), (Point{-1.0, 8.0}));
}

TEST(Evaluator, PutsPointsOutsideTheBoxOntoIt) {
  const Quadratic quadratic;
  Evaluator evaluator(quadratic, box(0.0, 0.0, -1.0, 1.0), {});
  EXPECT_EQ(evaluator.value(Point{5.0, -5.0}), 0.5 * 4.0);
}

TEST(Evaluator, KeepsTheBestPointAndTracesOnlyProgress) {
  const Quadratic quadratic;
  Evaluator evaluator(quadratic, box(0.0, 0.0, -9.0, 9.0), {});
  evaluator.begin();
  evaluator.value(Point{2.0, -1.0});
  evaluator.value(Point{5.0, 5.0});
  const OptimizationResult result = evaluator.finish(StopReason::kConverged);
  EXPECT_EQ(result.x, (Point{2.0, -1.0}));
  EXPECT_EQ(result.value, 0.5);
  EXPECT_EQ(result.initial_value, 0.5 * (9.0 + 4.0));
  EXPECT_EQ(result.evaluations, 3);
  ASSERT_EQ(result.trace.size(), 2u);
  EXPECT_EQ(result.trace[1].evaluations, 2);
  EXPECT_EQ(result.stop, StopReason::kConverged);
}

TEST(Evaluator, AllowsExactlyTheEvaluationsOfTheBudget) {
  const Quadratic quadratic;
  Evaluator evaluator(quadratic, box(0.0, 0.0, -9.0, 9.0), {.evaluations = 2});
  evaluator.value(Point{0.0, 0.0});
  evaluator.value(Point{1.0, 0.0});
  EXPECT_THROW(evaluator.value(Point{3.0, -1.0}), Evaluator::Stopped);
  EXPECT_EQ(evaluator.try_evaluate(Point{3.0, -1.0}, {}), Trial::kOver);
  EXPECT_EQ(quadratic.calls, 2);
  const OptimizationResult result = evaluator.finish(StopReason::kConverged);
  EXPECT_EQ(result.stop, StopReason::kEvaluationBudget);
  EXPECT_EQ(result.evaluations, 2);
}

TEST(Evaluator, StartsNoEvaluationAfterTheTimeIsUp) {
  const Quadratic quadratic;
  double now = 100.0;
  Evaluator evaluator(quadratic, box(0.0, 0.0, -9.0, 9.0), {.seconds = 2.0}, [&] { return now; });
  evaluator.value(Point{0.0, 0.0});
  now = 101.9;
  evaluator.value(Point{1.0, 0.0});
  now = 102.0;
  EXPECT_THROW(evaluator.value(Point{3.0, -1.0}), Evaluator::Stopped);
  const OptimizationResult result = evaluator.finish(StopReason::kNotRun);
  EXPECT_EQ(result.stop, StopReason::kTimeBudget);
  EXPECT_EQ(result.seconds, 2.0);
  EXPECT_NEAR(result.trace.back().seconds, 1.9, 1e-12);
}

TEST(Evaluator, EndsAtTheTarget) {
  const Quadratic quadratic;
  Evaluator evaluator(quadratic, box(0.0, 0.0, -9.0, 9.0), {.target = 0.5});
  EXPECT_EQ(evaluator.try_evaluate(Point{0.0, 0.0}, {}), Trial::kFinite);
  EXPECT_EQ(evaluator.try_evaluate(Point{2.0, -1.0}, {}), Trial::kOver);
  const OptimizationResult result = evaluator.finish(StopReason::kNoProgress);
  EXPECT_EQ(result.stop, StopReason::kTargetReached);
  EXPECT_EQ(result.value, 0.5);
}

TEST(Evaluator, NotANumberIsARejectedStepAndNeverTheBest) {
  const ValueOnly function(1, [](std::span<const double> x) { return x[0] > 0.5 ? kNan : x[0]; });
  const std::vector<Variable> line = {{"x", "1", 0.0, -1.0, 1.0, 1.0}};
  Evaluator evaluator(function, line, {});
  evaluator.begin();
  EXPECT_EQ(evaluator.value(Point{0.75}), std::numeric_limits<double>::infinity());
  double value = 0.0;
  evaluator.value(Point{-0.25});
  EXPECT_EQ(evaluator.try_evaluate(Point{0.75}, {.value = &value}), Trial::kRejected);
  EXPECT_EQ(value, 0.25);  // as far above the worst, 0, as the best lies below it
  const OptimizationResult result = evaluator.finish(StopReason::kConverged);
  EXPECT_EQ(result.stop, StopReason::kConverged);
  EXPECT_EQ(result.x, Point{-0.25});
  EXPECT_EQ(result.evaluations, 4);
}

TEST(Evaluator, NotANumberAtTheStartOrAsAStepEndsTheSearch) {
  const ValueOnly nowhere(1, [](std::span<const double>) { return kNan; });
  const std::vector<Variable> line = {{"x", "1", 0.0, -1.0, 1.0, 1.0}};
  Evaluator evaluator(nowhere, line, {});
  EXPECT_THROW(evaluator.begin(), Evaluator::Stopped);
  EXPECT_EQ(evaluator.finish(StopReason::kConverged).stop, StopReason::kNotFinite);

  const ValueOnly function(1, [](std::span<const double> x) { return x[0]; });
  Evaluator steps(function, line, {});
  EXPECT_EQ(steps.try_evaluate(Point{kNan}, {}), Trial::kOver);
  EXPECT_EQ(steps.finish(StopReason::kConverged).evaluations, 0);
}

TEST(Evaluator, RejectedResidualsHaveTheHalfSquareOfTheRejectedValue) {
  class Undefined final : public LeastSquaresProblem {
    std::array<double, 2> residuals(double x, double y) const override {
      return {x > 2.0 ? kNan : x - 3.0, 2.0 * (y + 1.0)};
    }
    std::array<double, 4> jacobian(double x, double /*y*/) const override {
      return {x > 1.0 ? kNan : 1.0, 0.0, 0.0, 2.0};
    }
  };
  const Undefined function;
  double value = 0.0, gradient[2], residuals[2], jacobian[4];
  const ObjectiveOutputs all{&value, gradient, residuals, jacobian};
  Evaluator evaluator(function, box(0.0, 0.0, -9.0, 9.0), {});
  evaluator.begin();
  EXPECT_EQ(evaluator.try_evaluate(Point{0.0, 0.0}, all), Trial::kFinite);
  for (const double x : {1.5, 2.5}) {  // the slopes alone; all
    EXPECT_EQ(evaluator.try_evaluate(Point{x, 0.0}, all), Trial::kRejected);
    EXPECT_EQ(value, 2.0 * 6.5);
    EXPECT_DOUBLE_EQ(residuals[0] * residuals[0] + residuals[1] * residuals[1], 2.0 * value);
    for (const double slope : {gradient[0], gradient[1], jacobian[0]}) EXPECT_EQ(slope, 0.0);
  }

  Evaluator blind(function, box(1.5, 0.0, -9.0, 9.0), {});
  blind.begin();
  EXPECT_EQ(blind.try_evaluate(Point{0.0, 0.0}, all), Trial::kOver);
  EXPECT_EQ(blind.finish(StopReason::kConverged).stop, StopReason::kNotFinite);
}

TEST(Evaluator, DifferencesTakeTheSideWhereTheObjectiveIsFinite) {
  const ValueOnly function(2, [](std::span<const double> x) {
    return std::sqrt(x[0]) + std::pow(x[0], 2) + std::sqrt(-x[1]) + std::pow(x[1], 2);
  });
  Evaluator evaluator(function, box(0.0, 0.0, -9.0, 9.0), {});
  double gradient[2];
  EXPECT_TRUE(evaluator.evaluate(Point{1e-6, -1e-6}, {.gradient = gradient}));
  // Steps of 6e-6 are coarse for √x at 1e-6, whose slope is 500.
  EXPECT_NEAR(gradient[0], 500.0, 350.0);
  EXPECT_NEAR(gradient[1], -500.0, 350.0);
}

TEST(Evaluator, CarriesExceptionsThroughCallbacks) {
  const Throwing function(2);
  Evaluator evaluator(function, box(0.0, 0.0, -9.0, 9.0), {});
  EXPECT_EQ(evaluator.try_evaluate(Point{0.0, 0.0}, {}), Trial::kFinite);
  EXPECT_EQ(evaluator.try_evaluate(Point{1.0, 0.0}, {}), Trial::kOver);
  EXPECT_EQ(evaluator.try_evaluate(Point{1.0, 0.0}, {}), Trial::kOver);
  EXPECT_EQ(function.calls, 2);
  EXPECT_THROW(evaluator.finish(StopReason::kConverged), Boom);
}

TEST(Evaluator, ScansWithinTheBudgetAndKeepsOneEvaluationForTheAnswer) {
  const Quadratic quadratic;
  Evaluator evaluator(quadratic, box(0.0, 0.0, -9.0, 9.0), {.evaluations = 5});
  evaluator.begin();
  evaluator.open_scan();
  EXPECT_EQ(evaluator.evaluations_left(), 3);
  Point values(3);
  evaluator.scan(0, Point{1.0, 3.0, 5.0}, values);
  EXPECT_EQ(values[1], 0.5 * 4.0);
  evaluator.move(0, 3.0);
  EXPECT_THROW(evaluator.scan(1, Point{-1.0}, std::span(values).first(1)), Evaluator::Stopped);
  const OptimizationResult result = evaluator.finish(StopReason::kSearchCompleted);
  EXPECT_EQ(result.evaluations, 5);
  EXPECT_EQ(quadratic.calls, 5);
  EXPECT_EQ(result.x, (Point{3.0, 0.0}));
  EXPECT_EQ(result.value, 2.0);
  EXPECT_EQ(result.stop, StopReason::kEvaluationBudget);
}

TEST(Evaluator, ABudgetOfOneEvaluationIsSpentOnTheInitialPoint) {
  const Quadratic quadratic;
  Evaluator evaluator(quadratic, box(0.0, 0.0, -9.0, 9.0), {.evaluations = 1});
  evaluator.begin();
  evaluator.open_scan();
  Point values(1);
  EXPECT_THROW(evaluator.scan(0, Point{1.0}, values), Evaluator::Stopped);
  const OptimizationResult result = evaluator.finish(StopReason::kSearchCompleted);
  EXPECT_EQ(quadratic.calls, 1);
  EXPECT_EQ(result.value, 6.5);
}

TEST(Evaluator, RefusesWhatCannotBeSearched) {
  const Quadratic quadratic;
  EXPECT_THROW(Evaluator(quadratic, box(5.0, 0.0, -1.0, 1.0), {}), InvalidInput);
  EXPECT_THROW(Evaluator(quadratic, box(0.0, 0.0, -1.0, 1.0, 0.0), {}), InvalidInput);
  EXPECT_THROW(Evaluator(quadratic, box(1.0, 1.0, 1.0, 1.0), {}), InvalidInput);
  EXPECT_THROW(Evaluator(quadratic, box(0.0, 0.0, -1.0, 1.0), {.evaluations = 0}), InvalidInput);
  EXPECT_THROW(Evaluator(quadratic, box(0.0, 0.0, -1.0, 1.0), {.seconds = 0.0}), InvalidInput);
  const auto one = box(0.0, 0.0, -1.0, 1.0);
  EXPECT_THROW(Evaluator(quadratic, std::span(one).first(1), {}), InvalidInput);
}

TEST(StopReason, EveryReasonHasAWordAndASentenceOfItsOwn) {
  std::vector<std::string_view> words;
  for (int i = 0; i <= static_cast<int>(StopReason::kNoProgress); ++i) {
    const auto reason = static_cast<StopReason>(i);
    EXPECT_TRUE(explain(reason).ends_with("."));
    for (const auto word : words) EXPECT_NE(word, name_of(reason));
    words.push_back(name_of(reason));
  }
}

}  // namespace
}  // namespace modcal::evaluator_test
