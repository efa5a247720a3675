#include "libcalib/problem/covariance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal::covariance_test {
namespace {

TEST(Covariance, IsTheInverseOfTheNormalMatrixInUserUnits) {
  const Rosenbrock function;
  // J = (−1, 0; −20, 10) at (1, 1): JᵀJ = (401, −200; −200, 100), its determinant 100.
  for (const double scale : {1.0, 0.01}) {
    const Covariance covariance =
        covariance_at(function, box(0.0, 0.0, -2.0, 2.0, scale), std::vector<double>{1.0, 1.0});
    ASSERT_TRUE(covariance.full_rank);
    // Condition 2500: rounding is 1e-12.
    EXPECT_NEAR(covariance(0, 0), 1.0, 1e-11);
    EXPECT_NEAR(covariance(0, 1), 2.0, 1e-11);
    EXPECT_NEAR(covariance(1, 0), 2.0, 1e-11);
    EXPECT_NEAR(covariance(1, 1), 4.01, 1e-11);
    EXPECT_NEAR(covariance.standard_deviation(1), std::sqrt(4.01), 1e-11);
  }
}

TEST(Covariance, SaysWhenACombinationMovesNothing) {
  class Blind final : public LeastSquaresProblem {
    std::array<double, 2> residuals(double x, double y) const override { return {x + y, 0.0}; }
    std::array<double, 4> jacobian(double, double) const override { return {1.0, 1.0, 0.0, 0.0}; }
  };
  const Covariance covariance =
      covariance_at(Blind(), box(0.0, 0.0, -2.0, 2.0), std::vector<double>{0.5, 0.5});
  EXPECT_FALSE(covariance.full_rank);
  EXPECT_TRUE(covariance.matrix.empty());
  EXPECT_TRUE(std::isnan(covariance.standard_deviation(0)));
}

TEST(Covariance, NeedsResidualsAndAPointInTheBox) {
  const auto variables = box(0.0, 0.0, -2.0, 2.0);
  EXPECT_THROW(covariance_at(Branin(), variables, std::vector<double>{0.0, 0.0}), InvalidInput);
  EXPECT_THROW(covariance_at(Rosenbrock(), variables, std::vector<double>{3.0, 0.0}), InvalidInput);
  EXPECT_THROW(covariance_at(Rosenbrock(), variables, std::vector<double>{0.0}), InvalidInput);
}

}  // namespace
}  // namespace modcal::covariance_test
