// Sparse amplitudes: what the data ask for is found, what they do not is left out.
#include "libinverse/structure/force/relevance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/stop_scope.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal::relevance_test {
namespace {

using Index = Eigen::Index;

struct Equations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd score;
};

// y = M p + e, e ~ N(0, 1): A = MᵀM, b = Mᵀy.
Equations equations_of(const Eigen::VectorXd& amplitudes) {
  const Index rows = 200, columns = amplitudes.size();
  std::vector<double> normal(static_cast<std::size_t>(rows * (columns + 1)));
  fill_standard_normal(StreamKey(3).with("relevance"), normal);
  const Eigen::Map<Eigen::MatrixXd> all(normal.data(), rows, columns + 1);
  const Eigen::MatrixXd matrix = all.leftCols(columns);
  const Eigen::VectorXd y = matrix * amplitudes + all.col(columns);
  return {matrix.transpose() * matrix, matrix.transpose() * y};
}

TEST(Relevance, FindsTheFewThatAreThere) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(60);
  truth[7] = 5.0, truth[31] = -3.0, truth[50] = 1.5;
  const auto [matrix, score] = equations_of(truth);
  const Relevance found = determine_relevance(matrix, score);
  // An amplitude has the deviation 1/√200 = 0.07 of the noise; four of them.
  for (Index j = 0; j < truth.size(); ++j) EXPECT_NEAR(found.mean[j], truth[j], 0.29) << j;
  EXPECT_LT((found.mean.array().abs() > 1e-3).count(), 30);
  for (const Index j : {7, 31, 50}) {
    const auto at = std::ranges::find(found.chosen, j) - found.chosen.begin();
    ASSERT_LT(at, std::ssize(found.chosen)) << j;
    EXPECT_NEAR(found.root.col(at).norm(), 0.07, 0.02);
  }
}

TEST(Relevance, TellsFewFromMany) {
  Eigen::VectorXd one = Eigen::VectorXd::Zero(60);
  one[7] = 5.0;
  const Equations few = equations_of(one), many = equations_of(Eigen::VectorXd::Ones(60));
  EXPECT_TRUE(determine_relevance(few.matrix, few.score).are_few());
  EXPECT_FALSE(determine_relevance(many.matrix, many.score).are_few());
}

TEST(Relevance, HasTheCovarianceOfItsEquations) {
  const auto [matrix, score] = equations_of(Eigen::VectorXd::Ones(150));
  const Eigen::VectorXd widths = Eigen::VectorXd::Constant(150, 2.0);
  const Relevance found = posterior_of(matrix, score, widths);
  Eigen::MatrixXd precision = matrix;
  precision.diagonal().array() += 0.5;
  // Of a condition of 1e3: 1e3 roundings of 150 terms.
  const Eigen::MatrixXd one = found.root.transpose() * found.root * precision;
  EXPECT_TRUE(one.isIdentity(1e-10)) << (one - Eigen::MatrixXd::Identity(150, 150)).norm();
  EXPECT_TRUE((precision * found.mean).isApprox(score, 1e-10));
}

TEST(Relevance, EndsWhereItIsStopped) {
  const auto [matrix, score] = equations_of(Eigen::VectorXd::Ones(10));
  const std::atomic<bool> wish = true;
  const StopToken stop(wish);
  const StopScope listening(stop);
  EXPECT_THROW(determine_relevance(matrix, score), Interrupted);
}

TEST(Relevance, OfNoiseAloneHasNoEvidence) {
  const auto [matrix, score] = equations_of(Eigen::VectorXd::Zero(60));
  const Relevance found = determine_relevance(matrix, score);
  EXPECT_LT(found.mean.cwiseAbs().maxCoeff(), 0.29);
  // What the few amplitudes that noise favors gain, about 1 each, is less than they cost.
  EXPECT_GE(posterior_of(matrix, score, found.widths).evidence, 0.0);
  EXPECT_LT(found.evidence, 0.0);
}

// Those of k are 60 · 59 ⋯ (61 − k)/k!.
TEST(Relevance, CountsTheWaysToChoose) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(60);
  truth[7] = 500.0, truth[31] = -300.0, truth[50] = 150.0;
  const auto [matrix, score] = equations_of(truth);
  const Relevance found = determine_relevance(matrix, score);
  double ways = 1.0;
  for (std::size_t j = 0; j < found.chosen.size(); ++j) {
    ways *= static_cast<double>(60 - j) / static_cast<double>(j + 1);
  }
  EXPECT_LT(found.chosen.size(), 20u);
  EXPECT_NEAR(posterior_of(matrix, score, found.widths).evidence - found.evidence, std::log(ways),
              1e-6);
}

TEST(Relevance, OfOneSignIsTheLeastOfTheQuadratic) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(20);
  truth[3] = 2.0, truth[4] = -2.0, truth[12] = 1.0;
  const auto [matrix, score] = equations_of(truth);
  const Eigen::VectorXd widths = Eigen::VectorXd::Constant(20, 10.0);
  const Eigen::VectorXd p = non_negative_mean(matrix, score, widths);
  Eigen::MatrixXd ridged = matrix;
  ridged.diagonal() += widths.cwiseInverse();
  const Eigen::VectorXd slope = ridged * p - score;
  // The conditions of Karush, Kuhn and Tucker, to the rounding of the score's size.
  for (Index j = 0; j < p.size(); ++j) {
    EXPECT_GE(p[j], 0.0);
    EXPECT_GE(slope[j], -1e-8 * score.norm());
    EXPECT_NEAR(p[j] * slope[j], 0.0, 1e-7 * score.norm());
  }
  EXPECT_EQ(p[4], 0.0);
}

// Of 10 (1, 1)/√2 and (1, 0) the first serves y = (1, −0.2) better, but beside the second it would
// be negative, −0.2 of (1, 1): it has to leave again, and the second alone gives 1.
TEST(Relevance, OfOneSignLeavesAgainWhatAnotherServesBetter) {
  Eigen::Matrix2d columns;
  columns << 10.0 / std::sqrt(2.0), 1.0, 10.0 / std::sqrt(2.0), 0.0;
  const Eigen::Vector2d y(1.0, -0.2);
  const Eigen::VectorXd p = non_negative_mean(
      columns.transpose() * columns, columns.transpose() * y, Eigen::VectorXd::Constant(2, 1e12));
  EXPECT_EQ(p[0], 0.0);
  EXPECT_NEAR(p[1], 1.0, 2e-12);  // the width's 1e-12
}

// The sum of two amplitudes is told to 1e−12 of their widths, the difference not at all: beside
// 1e24 the 1 of its prior is lost.
TEST(Relevance, ThatRoundingAloneTellsHasNoEvidence) {
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(2, 2, 1e24);
  const Eigen::VectorXd score = Eigen::Vector2d(1e24, 1e24);
  const Relevance found = posterior_of(matrix, score, Eigen::VectorXd::Constant(2, 1.0));
  EXPECT_EQ(found.evidence, -std::numeric_limits<double>::infinity());
  const Relevance told = posterior_of(Eigen::Matrix2d::Identity(), Eigen::Vector2d(3.0, 0.0),
                                      Eigen::VectorXd::Constant(2, 1.0));
  // y = 3 with p ~ N(0, 1) and noise of 1: 9/4 − ln 2.
  EXPECT_NEAR(told.evidence, 2.25 - std::log(2.0), 1e-14);
}

}  // namespace
}  // namespace modcal::relevance_test
