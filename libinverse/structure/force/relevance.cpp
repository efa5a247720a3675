#include "libinverse/structure/force/relevance.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "libinverse/structure/tuning.hpp"
#include "libsim/base/stop_scope.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

std::vector<Index> relevant(const Eigen::VectorXd& widths) {
  std::vector<Index> chosen;
  const double least = 1e-6 * widths.maxCoeff();
  for (Index j = 0; j < widths.size(); ++j) {
    if (widths[j] > least) chosen.push_back(j);
  }
  return chosen;
}

// ln of how many sets of `some` there are among `all`.
double log_choices(double all, double some) {
  return std::lgamma(all + 1.0) - std::lgamma(some + 1.0) - std::lgamma(all - some + 1.0);
}

// Of a lower triangle, by blocks of columns: what stands above them is zero.
Eigen::MatrixXd inverse_of_lower(const Eigen::MatrixXd& lower) {
  const Index size = lower.rows(), block = 64;
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(size, size);
  for (Index j = 0; j < size; j += block) {
    const Index left = size - j;
    auto columns = inverse.block(j, j, left, std::min(block, left));
    lower.bottomRightCorner(left, left).triangularView<Eigen::Lower>().solveInPlace(columns);
  }
  return inverse;
}

}  // namespace

Relevance posterior_of(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                       const Eigen::VectorXd& widths) {
  Relevance result{.widths = widths,
                   .chosen = relevant(widths),
                   .mean = Eigen::VectorXd::Zero(b.size()),
                   .evidence = -std::numeric_limits<double>::infinity()};
  const std::vector<Index>& chosen = result.chosen;
  // In units of the widths the matrix is I + D A D: never singular.
  const Eigen::VectorXd root = widths(chosen).cwiseSqrt();
  Eigen::MatrixXd matrix = root.asDiagonal() * a(chosen, chosen) * root.asDiagonal();
  matrix.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> solver(matrix);
  const Eigen::VectorXd score = root.cwiseProduct(b(chosen)), scaled = solver.solve(score);
  result.mean(chosen) = root.cwiseProduct(scaled);
  result.root = inverse_of_lower(solver.matrixLLT()) * root.asDiagonal();
  // The data may tell some combinations 1e16 times as well as others; then rounding is all there
  // is.
  const bool is_right =
      solver.info() == Eigen::Success && (matrix * scaled - score).norm() <= 1e-6 * score.norm();
  if (!is_right) return result;
  result.evidence = 0.5 * score.dot(scaled) - solver.matrixLLT().diagonal().array().log().sum();
  return result;
}

Relevance determine_relevance(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  // All alike at first, as large as the whole score allows.
  const double start = std::max(
      b.squaredNorm() / (a * b).squaredNorm() * b.squaredNorm() / static_cast<double>(b.size()),
      std::numeric_limits<double>::min());
  Relevance result = posterior_of(a, b, Eigen::VectorXd::Constant(b.size(), start));
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    throw_if_stopped();
    Eigen::VectorXd widths = result.widths;
    for (Index i = 0; i < std::ssize(result.chosen); ++i) {
      const Index j = result.chosen[static_cast<std::size_t>(i)];
      const double told = 1.0 - result.root.col(i).squaredNorm() / widths[j];
      widths[j] = result.mean[j] * result.mean[j] / std::max(told, 1e-12);
    }
    widths = widths.cwiseMax(1e-7 * widths.maxCoeff());
    const double before = result.evidence;
    result = posterior_of(a, b, widths);
    // Where they are not few, further sweeps leave out one after another.
    if ((sweep > 10 && !result.are_few()) ||
        (sweep > 20 && std::abs(result.evidence - before) < 1e-4)) {
      break;
    }
  }
  result.evidence -=
      log_choices(static_cast<double>(b.size()), static_cast<double>(result.chosen.size()));
  return result;
}

Eigen::VectorXd non_negative_mean(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                  const Eigen::VectorXd& widths) {
  const std::vector<Index> all = relevant(widths);
  std::vector<bool> free(all.size(), false);
  Eigen::MatrixXd matrix = a(all, all);
  matrix.diagonal() += widths(all).cwiseInverse();
  const Eigen::VectorXd score = b(all);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(score.size());
  for (std::size_t round = 0; round < 3 * all.size(); ++round) {
    const Eigen::VectorXd slope = score - matrix * x;
    Index best = -1;
    for (Index j = 0; j < x.size(); ++j) {
      const bool rises = !free[static_cast<std::size_t>(j)] && slope[j] > 1e-9 * score.norm();
      if (rises && (best < 0 || slope[j] > slope[best])) best = j;
    }
    if (best < 0) break;
    free[static_cast<std::size_t>(best)] = true;
    while (true) {
      std::vector<Index> chosen;
      for (Index j = 0; j < x.size(); ++j) {
        if (free[static_cast<std::size_t>(j)]) chosen.push_back(j);
      }
      const Eigen::VectorXd wanted = matrix(chosen, chosen).ldlt().solve(score(chosen));
      double share = 1.0;
      for (Index i = 0; i < wanted.size(); ++i) {
        const double from = x[chosen[static_cast<std::size_t>(i)]];
        if (wanted[i] <= 0.0) share = std::min(share, from / (from - wanted[i]));
      }
      for (Index i = 0; i < wanted.size(); ++i) {
        double& value = x[chosen[static_cast<std::size_t>(i)]];
        value += share * (wanted[i] - value);
        if (share < 1.0 && value < 1e-12 * x.maxCoeff()) {
          value = 0.0;
          free[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])] = false;
        }
      }
      if (share >= 1.0) break;
    }
  }
  Eigen::VectorXd result = Eigen::VectorXd::Zero(b.size());
  result(all) = x;
  return result;
}

}  // namespace modcal
