#include "libcalib/optimizers/gsl_optimizer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal::gsl_optimizer_test {
namespace {

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

}  // namespace
}  // namespace modcal::gsl_optimizer_test
