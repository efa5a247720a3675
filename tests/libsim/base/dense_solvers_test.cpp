#include "libsim/base/dense_solvers.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace modcal::dense_solvers_test {
namespace {

// Entries of order 1 and condition numbers below 1e3: 1e-12 leaves three digits beyond rounding.
constexpr double kRounding = 1e-12;

Eigen::MatrixXd symmetric() {
  Eigen::MatrixXd matrix(3, 3);
  matrix << 4.0, 1.0, 0.5, 1.0, 3.0, -0.25, 0.5, -0.25, 2.0;
  return matrix;
}

TEST(DenseSolvers, SolveForVectorsAndMatricesAlike) {
  const Eigen::MatrixXd a = symmetric();
  const Eigen::VectorXd x = Eigen::Vector3d(1.0, -2.0, 0.5);
  EXPECT_LT((SemidefiniteSolver(a).solve(a * x) - x).norm(), kRounding);
  EXPECT_LT((PositiveSolver(a).solve(a * x) - x).norm(), kRounding);
  EXPECT_LT((SemidefiniteSolver(a).solve(a) - Eigen::MatrixXd::Identity(3, 3)).norm(), kRounding);
  EXPECT_LT((PositiveSolver(a).solve(a) - Eigen::MatrixXd::Identity(3, 3)).norm(), kRounding);
  EXPECT_LT((solve_general(a, a * a) - a).norm(), kRounding);
}

TEST(DenseSolvers, ReadTheLowerTriangleAlone) {
  Eigen::MatrixXd lower = symmetric();
  lower.triangularView<Eigen::StrictlyUpper>().setConstant(7.0);
  const Eigen::VectorXd right = Eigen::Vector3d(1.0, 2.0, 3.0);
  EXPECT_EQ(SemidefiniteSolver(lower).solve(right), SemidefiniteSolver(symmetric()).solve(right));
  EXPECT_EQ(PositiveSolver(lower).solve(right), PositiveSolver(symmetric()).solve(right));
  EXPECT_EQ(symmetric_eigenvalues(lower), symmetric_eigenvalues(symmetric()));
}

TEST(DenseSolvers, WhitenByTheCholeskyFactor) {
  const Eigen::MatrixXd a = symmetric();
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(3, 3);
  const Eigen::MatrixXd root = whiten(PositiveSolver(a), one);
  EXPECT_LT((root * a * root.transpose() - one).norm(), kRounding);
  const Eigen::VectorXd right = Eigen::Vector3d(1.0, 2.0, 3.0);
  EXPECT_LT((whiten(PositiveSolver(a), right) - root * right).norm(), kRounding);
}

TEST(DenseSolvers, SayWhereAMatrixIsNotPositive) {
  Eigen::MatrixXd matrix = symmetric();
  matrix(2, 2) = -1.0;
  EXPECT_NE(PositiveSolver(matrix).factor().info(), Eigen::Success);
  EXPECT_FALSE(generalized_eigen(symmetric(), matrix).found);
}

TEST(DenseSolvers, GeneralizedEigenvaluesSolveTheirEquation) {
  const Eigen::MatrixXd a = symmetric(), b = symmetric() + 2.0 * Eigen::MatrixXd::Identity(3, 3);
  const GeneralizedEigen eigen = generalized_eigen(a, b);
  ASSERT_TRUE(eigen.found);
  EXPECT_LT((a * eigen.vectors - b * eigen.vectors * eigen.values.asDiagonal()).norm(), kRounding);
  EXPECT_LT(eigen.values[0], eigen.values[2]);
}

// Of two unknowns that the data tell in sum alone each has half.
TEST(DenseSolvers, LeastNormSharesWhatIsToldInSum) {
  Eigen::MatrixXd a(2, 2);
  a << 1.0, 1.0, 1.0, 1.0;
  const Eigen::VectorXd x = least_norm_solution(a, Eigen::Vector2d(3.0, 3.0), 1e-11);
  EXPECT_LT((x - Eigen::Vector2d(1.5, 1.5)).norm(), kRounding);
  EXPECT_LT((pseudo_inverse(a, 1e-11) - 0.25 * a).norm(), kRounding);
}

TEST(DenseSolvers, QrSpansTheColumns) {
  Eigen::MatrixXd a(4, 2);
  a << 1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0;
  const ThinQr qr(a);
  EXPECT_LT((qr.q() * qr.r() - a).norm(), kRounding);
  const Eigen::VectorXd x = Eigen::Vector2d(2.0, -1.0), b = a * x;
  EXPECT_LT((qr.solve(b) - x).norm(), kRounding);
}

}  // namespace
}  // namespace modcal::dense_solvers_test
