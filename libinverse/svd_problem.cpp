#include "libinverse/svd_problem.hpp"

#include <Eigen/SVD>
#include <utility>
#include <vector>

#include "libsim/base/error.hpp"

namespace modcal {

SvdProblem::SvdProblem(const Eigen::MatrixXd& matrix) : problem_({}, {}, {}, 0) {
  MODCAL_REQUIRE(matrix.size() > 0 && matrix.allFinite(),
                 "a {} x {} matrix cannot be inverted: it needs entries, all of them finite",
                 matrix.rows(), matrix.cols());
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
  left_ = svd.matrixU();
  right_ = svd.matrixV();
  const Eigen::VectorXd& sigma = svd.singularValues();
  std::vector<double> multiplicity(static_cast<std::size_t>(sigma.size()), 1.0);
  problem_ = SpectralOperator({sigma.begin(), sigma.end()}, std::move(multiplicity), {},
                              static_cast<std::size_t>(matrix.rows()));
}

SvdSolution SvdProblem::solve(const Eigen::VectorXd& data, const Regularizer& regularizer,
                              const ParameterChoice& choice, double noise_rms) const {
  MODCAL_REQUIRE(data.size() == left_.rows() && data.allFinite(),
                 "{} data for a matrix of {} rows: one finite number per row is needed",
                 data.size(), left_.rows());
  const Eigen::VectorXd coefficients = left_.transpose() * data;
  std::vector<double> power(problem_.size());
  for (std::size_t i = 0; i < power.size(); ++i) {
    const double value = coefficients[problem_.order()[i]];
    power[i] = value * value;
  }
  const SpectralData spectral{.problem = &problem_,
                              .power = power,
                              .outside_power = (data - left_ * coefficients).squaredNorm(),
                              .noise_rms = noise_rms};
  SvdSolution solution;
  solution.choice = choice.choose(regularizer, spectral);
  std::vector<double> factors(problem_.size());
  const std::span<const double> sigma = problem_.sigma_as_given();
  regularizer.filter_factors(sigma, solution.choice.parameter(), factors);
  Eigen::VectorXd filtered = Eigen::VectorXd::Zero(coefficients.size());
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (sigma[i] > 0.0) filtered[row] = factors[i] * coefficients[row] / sigma[i];
  }
  solution.x = right_ * filtered;
  return solution;
}

}  // namespace modcal
