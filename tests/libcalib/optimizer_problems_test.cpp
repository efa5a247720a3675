// The digits that optimizers promise on standard problems with known answers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "tests/libcalib/any_optimizer.hpp"

namespace modcal::optimizer_problems_test {
namespace {

bool searches(const OptimizerCase& one) { return one.way != Way::kSystematic; }
bool has_slopes(const OptimizerCase& one) {
  return one.way == Way::kLeastSquares || one.way == Way::kGradient;
}

/// Goes where the values lead it.
class Search : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, Search, testing::ValuesIn(cases_where(searches)), label_of);

class SearchOfSeveral : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, SearchOfSeveral,
                         testing::ValuesIn(cases_where([](const OptimizerCase& one) {
                           return searches(one) && one.way != Way::kLine;
                         })),
                         label_of);

class BySlopes : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, BySlopes, testing::ValuesIn(cases_where(has_slopes)), label_of);

/// Steepest descent never gets through a curved valley.
class ThroughValleys : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, ThroughValleys,
                         testing::ValuesIn(cases_where([](const OptimizerCase& one) {
                           return has_slopes(one) && !one.label.ends_with("steepest_descent");
                         })),
                         label_of);

class ByResiduals : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, ByResiduals,
                         testing::ValuesIn(cases_where([](const OptimizerCase& one) {
                           return one.way == Way::kLeastSquares;
                         })),
                         label_of);

class InTheWholeBox : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, InTheWholeBox,
                         testing::ValuesIn(cases_where([](const OptimizerCase& one) {
                           return one.way == Way::kGlobal;
                         })),
                         label_of);

/// What is promised in a box ten wide with curvatures of order one.
double quadratic_digits(Way way) {
  switch (way) {
    case Way::kLeastSquares:
      // The last step of a Gauss–Newton method is below 1e-9 of variables of size 5; what it leaves
      // is a fraction of it.
      return 5e-9;
    case Way::kGradient:
      // NLopt's searches end with steps of 1e-8 of the box, the others with slopes or steps of
      // 1e-10; steepest descent leaves a few times its last step.
      return 1e-7;
    case Way::kGlobal:
      return 1e-2;  // the share of the box that thousands of points tell apart
    default:
      // Models of values alone, interpolated from points 1e-3 apart, lose half their 16 digits
      // there: 1e-8/1e-3 in the slope.
      return 5e-6;
  }
}

TEST_P(SearchOfSeveral, AVariableMayStartOnItsBound) {
  const Quadratic function;
  const auto on_bound = optimizer().minimize(function, box(5.0, 0.0, -5.0, 5.0), enough());
  EXPECT_NEAR(on_bound.x[0], 3.0, quadratic_digits(way()));
  EXPECT_NEAR(on_bound.x[1], -1.0, quadratic_digits(way()));
}

TEST_P(Search, SolvesTheQuadratic) {
  const Quadratic function;
  const FunctionProblem problem(function, box(0.0, 0.0, -5.0, 5.0), one_variable());
  const auto result = problem.minimize(optimizer(), enough());
  const double tolerance = quadratic_digits(way());
  EXPECT_NEAR(result.x[0], 3.0, tolerance);
  EXPECT_NEAR(one_variable() ? -1.0 : result.x[1], -1.0, tolerance);
  EXPECT_NE(result.stop, StopReason::kNoProgress);
}

/// The quadratic, which is not a number at the n-th point other than the first.
class OnceUndefined final : public LeastSquaresProblem {
 public:
  explicit OnceUndefined(int at) : at_(at) {}

 private:
  std::array<double, 2> residuals(double x, double y) const override {
    const std::array point = {x, y};
    if (calls > 1 && point != last_ && points_++ == at_) undefined_ = point;
    last_ = point;
    if (point == undefined_) return {std::numeric_limits<double>::quiet_NaN(), 0.0};
    return {x - 3.0, 2.0 * (y + 1.0)};
  }
  std::array<double, 4> jacobian(double /*x*/, double /*y*/) const override {
    return {1.0, 0.0, 0.0, 2.0};
  }
  int at_;
  mutable int points_ = 1;
  mutable std::array<double, 2> last_ = {0.0, 0.0}, undefined_ = {1e300, 1e300};
};

/// What is promised where a value above all others stands in for one that is not finite.
double rejected_step_digits(Way way) {
  // Quasi-Newton matrices and interpolated models take the stand-in in and forget it by and by.
  if (way == Way::kGradient) return 2e-6;
  if (way == Way::kSimplex) return 5e-5;
  return way == Way::kGlobal ? 0.1 : quadratic_digits(way);
}

TEST_P(Search, OneValueThatIsNotFiniteIsARejectedStepAndNotTheEnd) {
  for (const int at : {1, 2, 4}) {
    const OnceUndefined function(at);
    const FunctionProblem problem(function, box(0.0, 0.0, -5.0, 5.0), one_variable());
    const auto result = problem.minimize(optimizer(), enough());
    EXPECT_NE(result.stop, StopReason::kNotFinite);
    // To a bracket in one variable the point is a wall.
    if (one_variable()) continue;
    const double tolerance = rejected_step_digits(way());
    EXPECT_NEAR(result.x[0], 3.0, tolerance) << "not finite at point " << at;
    EXPECT_NEAR(result.x[1], -1.0, tolerance) << "not finite at point " << at;
  }
}

TEST_P(ThroughValleys, SolvesRosenbrocksProblem) {
  const auto result = optimizer().minimize(Rosenbrock(), box(-1.2, 1.0, -2.0, 2.0), {});
  // Residuals vanish at the optimum: Gauss–Newton steps are quadratic. The least curvature of the
  // valley is 0.4, so that quasi-Newton steps end at 1e-10/0.4 of slope or sooner by rounding of a
  // value of 1e-13. CCSAQ and MMA replace the valley by separable functions and creep along it:
  // they end with steps of 1e-8 that shrink by 1e-3 or less each.
  const bool separable = GetParam().label.ends_with("CCSAQ") || GetParam().label.ends_with("MMA");
  const double tolerance = way() == Way::kLeastSquares ? 5e-9 : separable ? 1e-4 : 1e-6;
  EXPECT_NEAR(result.x[0], 1.0, tolerance);
  EXPECT_NEAR(result.x[1], 1.0, 2.0 * tolerance);
}

TEST_P(ByResiduals, SolvesPowellsBadlyScaledProblem) {
  const auto found = optimizer().minimize(
      PowellBadlyScaled(), {{{"x", "1", 0.0, -1.0, 1.0, 1.0}, {"y", "1", 1.0, 0.0, 20.0, 1.0}}},
      {});
  // y to the last step, 1e-9 of its size 9; xy = 1e-4 gives x with the same relative error.
  EXPECT_NEAR(found.x[0], PowellBadlyScaled::kX, 1e-9 * PowellBadlyScaled::kX);
  EXPECT_NEAR(found.x[1], PowellBadlyScaled::kY, 1e-9 * PowellBadlyScaled::kY);
}

TEST_P(ByResiduals, SolvesPowellsSingularProblem) {
  std::vector<Variable> four;
  for (const double start : {3.0, -1.0, 0.0, 1.0}) four.push_back({"x", "1", start, -9.0, 9.0});
  const auto found = optimizer().minimize(PowellSingular(), four, {});
  // Where the Hessian is singular the value is about 5 x⁴ and its slope 20 x³, which passes the
  // tolerance g of the slope at x = (g/20)^⅓; twice that for its direction.
  const double slope = optimizer().name() == "gsl" ? 1e-10 : 1e-12;
  const double x = std::cbrt(slope / 20.0);
  EXPECT_LE(found.value, 2.0 * 5.0 * std::pow(x, 4));
  for (const double value : found.x) EXPECT_NEAR(value, 0.0, 2.0 * x);
}

TEST_P(ThroughValleys, FitsASumOfDampedSinusoids) {
  const std::vector<Variable> variables = {{"omega_1", "rad/s", 11.7, 10.0, 14.0, 0.5},
                                           {"d_1", "1/s", 1.0, 0.1, 3.0, 0.5},
                                           {"omega_2", "rad/s", 19.4, 17.0, 21.0, 0.5},
                                           {"d_2", "1/s", 1.2, 0.1, 3.0, 0.5}};
  const auto result = optimizer().minimize(DampedSinusoids(), variables, {});
  // 200 samples over 2 s: curvatures of 7 and more, slopes and steps as in quadratic_digits().
  const double tolerance = quadratic_digits(way());
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(result.x[i], DampedSinusoids::kTruth[i], tolerance) << variables[i].name;
  }
}

TEST_P(InTheWholeBox, FindsBraninsMinimum) {
  const auto result = optimizer().minimize(Branin(), branin_box(), {.evaluations = 5000});
  // Curvatures at the three equal minima are below 60: 1e-2 of the variables is 3e-3 of the value.
  EXPECT_NEAR(result.value, Branin::kMinimum, 3e-3);
}

// Slopes that the objective does not give.

TEST_P(BySlopes, FormsMissingSlopesByDifferences) {
  const Quadratic quadratic;
  const Without function(quadratic, {.residuals = way() == Way::kLeastSquares});
  const auto result = optimizer().minimize(function, box(0.0, 0.0, -5.0, 5.0), {});
  EXPECT_EQ(result.evaluations, quadratic.calls);
  EXPECT_GT(result.difference_evaluations, 0);
  // The slope's error h² f‴/6 + ε f/h vanishes with f where residuals do: that of a quadratic is
  // rounding over h = 6e-6, 1e-16·8/6e-6 at worst, and less the nearer the minimum is.
  const double tolerance = quadratic_digits(way());
  EXPECT_NEAR(result.x[0], 3.0, tolerance);
  EXPECT_NEAR(result.x[1], -1.0, tolerance);
}

}  // namespace
}  // namespace modcal::optimizer_problems_test
