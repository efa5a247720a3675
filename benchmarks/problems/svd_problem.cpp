#include "benchmarks/problems/svd_problem.hpp"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

void require_matrix(const Eigen::MatrixXd& matrix) {
  MODCAL_REQUIRE(matrix.size() > 0 && matrix.allFinite(),
                 "a {} x {} matrix cannot be inverted: it needs entries, all of them finite",
                 matrix.rows(), matrix.cols());
}

// Columns are orthonormal cosines of rising frequency.
Eigen::MatrixXd cosine_basis(Eigen::Index n) {
  Eigen::MatrixXd basis(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double scale = std::sqrt((k == 0 ? 1.0 : 2.0) / static_cast<double>(n));
    const double pace = std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      basis(j, k) = scale * std::cos(pace * (static_cast<double>(j) + 0.5));
    }
  }
  return basis;
}

// The rms of all frequencies but 0, as for the bins of a record.
double reference_of(const std::vector<double>& omega) {
  double square = 0.0;
  for (const double value : omega) square += value * value;
  return omega.size() > 1 ? std::sqrt(square / static_cast<double>(omega.size() - 1)) : 1.0;
}

std::vector<double> penalties_of(const Regularizer& regularizer, const std::vector<double>& omega) {
  const double reference = reference_of(omega);
  std::vector<double> penalties;
  for (const double value : omega) penalties.push_back(regularizer.penalty(value, reference));
  return penalties;
}

}  // namespace

SvdProblem::SvdProblem(const Eigen::MatrixXd& matrix) : problem_({}, {}, {}, 0) {
  require_matrix(matrix);
  decompose(matrix, static_cast<std::size_t>(matrix.rows()), false);
}

SvdProblem::SvdProblem(const Eigen::MatrixXd& matrix, const Regularizer& regularizer, double step)
    : problem_({}, {}, {}, 0) {
  require_matrix(matrix);
  MODCAL_REQUIRE(step > 0.0 && std::isfinite(step), "step {:g} between samples must be > 0", step);
  const Eigen::Index n = matrix.cols();
  for (Eigen::Index k = 0; k < n; ++k) {
    omega_.push_back(std::numbers::pi * static_cast<double>(k) / (static_cast<double>(n) * step));
  }
  penalty_ = penalties_of(regularizer, omega_);
  cosines_ = cosine_basis(n);
  transformed_ = matrix * cosines_;
  Eigen::MatrixXd standard = transformed_;
  std::size_t rows = static_cast<std::size_t>(matrix.rows());
  if (penalty_[0] == 0.0) {
    const double norm = transformed_.col(0).norm();
    free_direction_ = Eigen::VectorXd::Zero(matrix.rows());
    if (norm > 0.0) {
      free_direction_ = transformed_.col(0) / norm;
      --rows;
    }
    standard -= free_direction_ * (free_direction_.transpose() * transformed_).eval();
  }
  const Eigen::Index free = penalty_[0] == 0.0 ? 1 : 0;
  for (Eigen::Index k = free; k < n; ++k) {
    standard.col(k) /= penalty_[static_cast<std::size_t>(k)];
  }
  decompose(standard.rightCols(n - free), rows, true);
}

void SvdProblem::decompose(const Eigen::MatrixXd& matrix, std::size_t rows, bool penalized) {
  if (matrix.cols() == 0) {  // nothing but the mean
    left_ = Eigen::MatrixXd::Zero(matrix.rows(), 0);
    right_ = Eigen::MatrixXd::Zero(0, 0);
    problem_ = SpectralOperator({}, {}, {}, rows, penalized);
    return;
  }
  ThinSvd svd(matrix);
  left_ = std::move(svd.left);
  right_ = std::move(svd.right);
  const Eigen::VectorXd& sigma = svd.values;
  std::vector<double> multiplicity(static_cast<std::size_t>(sigma.size()), 1.0);
  problem_ =
      SpectralOperator({sigma.begin(), sigma.end()}, std::move(multiplicity), {}, rows, penalized);
}

void SvdProblem::require_penalty_of(const Regularizer& regularizer) const {
  if (penalty_.empty()) {
    MODCAL_REQUIRE(!regularizer.has_penalty(),
                   "this regularizer weighs frequencies and the matrix of {} columns knows none: "
                   "prepare the problem for the regularizer, with the step between samples",
                   right_.rows());
    return;
  }
  const std::vector<double> wanted = penalties_of(regularizer, omega_);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    MODCAL_REQUIRE(wanted[k] == penalty_[k],
                   "this regularizer's penalty is {:g} at {:g} rad/s, the problem is prepared for "
                   "{:g}: prepare one for each regularizer",
                   wanted[k], omega_[k], penalty_[k]);
  }
}

Eigen::VectorXd SvdProblem::filtered(const Eigen::VectorXd& coefficients,
                                     const Regularizer& regularizer, double parameter) const {
  std::vector<double> factors(problem_.size());
  const std::span<const double> sigma = problem_.sigma_as_given();
  regularizer.filter_factors(sigma, parameter, factors);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(coefficients.size());
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (sigma[i] > 0.0) result[row] = factors[i] * coefficients[row] / sigma[i];
  }
  return right_ * result;
}

Eigen::VectorXd SvdProblem::from_standard_form(const Eigen::VectorXd& data,
                                               const Eigen::VectorXd& solution) const {
  if (penalty_.empty()) return solution;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(cosines_.cols());
  const Eigen::Index free = y.size() - solution.size();
  for (Eigen::Index k = free; k < y.size(); ++k) {
    y[k] = solution[k - free] / penalty_[static_cast<std::size_t>(k)];
  }
  if (free > 0 && free_direction_.squaredNorm() > 0.0) {
    y[0] = free_direction_.dot(data - transformed_ * y) / transformed_.col(0).norm();
  }
  return cosines_ * y;
}

SvdSolution SvdProblem::solve(const Eigen::VectorXd& data, const Regularizer& regularizer,
                              const ParameterChoice& choice, double noise_rms) const {
  MODCAL_REQUIRE(data.size() == left_.rows() && data.allFinite(),
                 "{} data for a matrix of {} rows: one finite number per row is needed",
                 data.size(), left_.rows());
  require_penalty_of(regularizer);
  Eigen::VectorXd seen = data;
  if (free_direction_.size() > 0) seen -= free_direction_ * free_direction_.dot(data);
  const Eigen::VectorXd coefficients = left_.transpose() * seen;
  std::vector<double> power(problem_.size());
  for (std::size_t i = 0; i < power.size(); ++i) {
    const double value = coefficients[problem_.order()[i]];
    power[i] = value * value;
  }
  const SpectralData spectral{.problem = &problem_,
                              .power = power,
                              .outside_power = (seen - left_ * coefficients).squaredNorm(),
                              .noise_rms = noise_rms};
  SvdSolution solution;
  solution.choice = choice.choose(regularizer, spectral);
  solution.x =
      from_standard_form(data, filtered(coefficients, regularizer, solution.choice.parameter()));
  return solution;
}

}  // namespace modcal
