// NIST's certified problems, and a handful of them that ask most of the adapters.
#include "benchmarks/nist/nist_problems.hpp"

#include <gtest/gtest.h>

#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/optimizers/gsl_optimizer.hpp"
#include "libcalib/optimizers/nlopt_optimizer.hpp"

namespace modcal::nist_problems_test {
namespace {

NistProblem problem_named(std::string_view name) { return NistProblem(MODCAL_NIST, name); }

double digits_of(const Optimizer& optimizer, std::string_view name, int start) {
  const NistProblem problem = problem_named(name);
  const Budget budget{.evaluations = 20000};
  return problem.digits(optimizer.minimize(problem, problem.variables(start), budget).x);
}

TEST(NistProblems, CertifiedParametersGiveTheCertifiedSumOfSquares) {
  EXPECT_EQ(nist_names().size(), 27u);
  for (const auto name : nist_names()) {
    if (name == "Lanczos1") continue;  // residuals of 1e-13 vanish in the 11 digits of parameters
    const NistProblem problem = problem_named(name);
    const double sum = 2.0 * problem.value(problem.certified());
    // Published with 11 digits; at the optimum rounded parameters change it in second order.
    EXPECT_NEAR(sum / problem.certified_sum_of_squares(), 1.0, 1.5e-10) << name;
  }
}

// Every digit of the sum below counts: the last decreases are 1e-14 of it.
TEST(NistProblems, OneSmallDecreaseDoesNotEndALeastSquaresSearch) {
  for (const int start : {1, 2}) {
    EXPECT_GE(digits_of(CeresOptimizer({}), "ENSO", start), 6.0) << start;
    EXPECT_GE(digits_of(GslOptimizer({.algorithm = "lm"}), "ENSO", start), 6.0) << start;
  }
}

// Among the 17 starts of 54 from which SLSQP's steps lead to where the model is not finite.
TEST(NistProblems, StepsToWhereTheModelIsNotFiniteAreRejected) {
  const NloptOptimizer slsqp({.algorithm = "LD_SLSQP"});
  EXPECT_GE(digits_of(slsqp, "Bennett5", 1), 6.0);
  EXPECT_GE(digits_of(slsqp, "BoxBOD", 1), 6.0);
  EXPECT_GE(digits_of(slsqp, "Gauss1", 2), 6.0);
  EXPECT_GE(digits_of(slsqp, "MGH17", 1), 6.0);
  EXPECT_GE(digits_of(slsqp, "Rat43", 2), 6.0);
}

// First steps along a huge slope, or a line search that fails, leave the search far from the
// optimum.
TEST(NistProblems, AQuasiNewtonSearchThatGivesUpStartsAfresh) {
  const NloptOptimizer slsqp({.algorithm = "LD_SLSQP"});
  for (const int start : {1, 2}) {
    EXPECT_GE(digits_of(slsqp, "Thurber", start), 6.0) << start;
    EXPECT_GE(digits_of(slsqp, "MGH10", start), 6.0) << start;
    EXPECT_GE(digits_of(NloptOptimizer({.algorithm = "LD_LBFGS"}), "Gauss2", start), 6.0) << start;
  }
}

}  // namespace
}  // namespace modcal::nist_problems_test
