#include "libcalib/likelihood/newton_step.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace modcal::newton_step_test {
namespace {

using Index = Eigen::Index;

constexpr Index kModes = 6;

// A quadratic cost, whose step from anywhere is exact: the law by generalized least squares of
// frequencies with the covariance D⁻¹ of the data, that of their further errors and their scatter.
void expect_least_squares(const Eigen::MatrixXd& further) {
  Eigen::VectorXd reference(kModes), measured(kModes), from(kModes);
  Eigen::MatrixXd slopes(kModes, 2);
  Eigen::MatrixXd data = Eigen::MatrixXd::Constant(kModes, kModes, 4e-11);
  for (Index i = 0; i < kModes; ++i) {
    const double n = static_cast<double>(i + 1), stiff = 1.0 + 1e-4 * n * n;
    reference[i] = std::log(200.0 * n * std::sqrt(stiff));
    measured[i] = 1e-5 * std::sin(3.0 * n);
    from[i] = 1e-5 * std::cos(2.0 * n);
    slopes.row(i) << 1.0, 0.5 * n * n / stiff;
    data(i, i) += 1e-10 * n;
  }
  const auto stated = [&](double width) {
    PriorEquations equations(kModes);
    equations.add_scatter(
        {.widths = Eigen::VectorXd::Constant(kModes, width), .inharmonicity = 1e-4}, reference);
    return equations;
  };
  LikelihoodPoint at;
  at.information = at.twice_weighted = 0.5 * data.inverse();
  at.slope = at.information * (from - measured);
  const LawPosterior law = law_of_step({stated(1e-5), stated(1e-2)}, at, from, {}, further);

  const Eigen::MatrixXd total = data + further + Eigen::MatrixXd::Identity(kModes, kModes) * 1e-10;
  const Eigen::MatrixXd weight = total.inverse();
  const Eigen::Matrix2d expected = (slopes.transpose() * weight * slopes).inverse();
  const Eigen::Vector2d change = expected * slopes.transpose() * weight * measured;
  // The wide statements' 1e-4 against the data's 1e-10, and the digits that precisions lose.
  EXPECT_NEAR(law.mean[0], std::log(200.0) + change[0], 1e-4 * std::sqrt(expected(0, 0)));
  EXPECT_NEAR(law.mean[1], 1e-4 + change[1], 1e-4 * std::sqrt(expected(1, 1)));
  EXPECT_NEAR(law.covariance(0, 0) / expected(0, 0), 1.0, 1e-4);
  EXPECT_NEAR(law.covariance(1, 1) / expected(1, 1), 1.0, 1e-4);
}

TEST(LawOfStep, IsThatOfLeastSquares) {
  expect_least_squares(Eigen::MatrixXd::Zero(kModes, kModes));
}

TEST(LawOfStep, TrustsAModeWithAFurtherErrorLess) {
  Eigen::MatrixXd further = Eigen::MatrixXd::Zero(kModes, kModes);
  further(1, 1) = 1e-9;
  further(4, 4) = 1e-8;
  expect_least_squares(further);
}

}  // namespace
}  // namespace modcal::newton_step_test
