#include "libcalib/problem/covariance.hpp"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libcalib/problem/evaluator.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// The linearized residuals: their Jacobian is all that matters.
class Linearized final : public ceres::CostFunction {
 public:
  Linearized(const std::vector<double>& jacobian, int residuals, int parameters)
      : jacobian_(jacobian) {
    set_num_residuals(residuals);
    mutable_parameter_block_sizes()->push_back(parameters);
  }
  bool Evaluate(const double* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    std::fill_n(residuals, num_residuals(), 0.0);
    if (jacobians && jacobians[0]) std::copy(jacobian_.begin(), jacobian_.end(), jacobians[0]);
    return true;
  }

 private:
  const std::vector<double>& jacobian_;
};

std::vector<double> scaled_jacobian(const ObjectiveFunction& function,
                                    std::span<const Variable> variables,
                                    std::span<const double> x) {
  std::vector<Variable> here(variables.begin(), variables.end());
  for (std::size_t i = 0; i < here.size(); ++i) here[i].initial = x[i];
  Evaluator evaluator(function, here, {});
  std::vector<double> jacobian(function.residual_count() * here.size());
  const bool finite = evaluator.try_evaluate(evaluator.start(), {.jacobian = jacobian.data()}) ==
                      Evaluator::Trial::kFinite;
  if (!finite) jacobian.clear();
  evaluator.finish(StopReason::kConverged);  // throws what the objective threw
  return jacobian;
}

}  // namespace

double Covariance::standard_deviation(std::size_t i) const {
  return full_rank ? std::sqrt((*this)(i, i)) : std::numeric_limits<double>::quiet_NaN();
}

Covariance covariance_at(const ObjectiveFunction& function, std::span<const Variable> variables,
                         std::span<const double> x) {
  MODCAL_REQUIRE(function.capabilities().sum_of_squares(),
                 "objective \"{}\" is no sum of squares: it has no covariance", function.name());
  MODCAL_REQUIRE(x.size() == variables.size(), "{} values are given for {} variables", x.size(),
                 variables.size());
  const std::size_t n = variables.size();
  Covariance result{.size = n};
  const std::vector<double> jacobian = scaled_jacobian(function, variables, x);
  if (jacobian.empty() || function.residual_count() < n) return result;
  std::vector<double> z(n, 0.0);
  ceres::Problem problem;
  problem.AddResidualBlock(
      new Linearized(jacobian, static_cast<int>(function.residual_count()), static_cast<int>(n)),
      nullptr, z.data());
  ceres::Covariance::Options settings;
  settings.algorithm_type = ceres::DENSE_SVD;
  settings.min_reciprocal_condition_number = 1e-14;
  settings.null_space_rank = 0;
  settings.num_threads = 1;
  ceres::Covariance covariance(settings);
  const double* block = z.data();
  const std::vector<std::pair<const double*, const double*>> blocks = {{block, block}};
  if (!covariance.Compute(blocks, &problem)) return result;
  result.matrix.resize(n * n);
  covariance.GetCovarianceBlock(block, block, result.matrix.data());
  for (std::size_t k = 0; k < n * n; ++k) {
    result.matrix[k] *= variables[k / n].scale * variables[k % n].scale;
  }
  result.full_rank = true;
  return result;
}

std::vector<double> deviations_by_information(const ObjectiveFunction& function,
                                              std::span<const double> x) {
  MODCAL_REQUIRE(function.capabilities().information,
                 "objective \"{}\" is no likelihood: it has no information", function.name());
  Eigen::MatrixXd information, prior;
  function.evaluate(x, {.information = &information, .prior = &prior});
  information += prior;
  constexpr double kNotTold = std::numeric_limits<double>::infinity();
  std::vector<double> deviations(x.size(), kNotTold);
  const Eigen::VectorXd unit =
      information.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(unit.asDiagonal() * information *
                                                              unit.asDiagonal());
  const Eigen::VectorXd& values = solver.eigenvalues();
  const double least = 1e-14 * values.maxCoeff();
  for (Eigen::Index i = 0; i < unit.size(); ++i) {
    double variance = 0.0, untold = unit[i] > 0.0 ? 0.0 : 1.0;
    for (Eigen::Index j = 0; j < unit.size(); ++j) {
      const double share = solver.eigenvectors()(i, j) * solver.eigenvectors()(i, j);
      if (values[j] > least) {
        variance += share / values[j];
      } else {
        untold += share;
      }
    }
    if (untold < 1e-6) deviations[static_cast<std::size_t>(i)] = unit[i] * std::sqrt(variance);
  }
  return deviations;
}

}  // namespace modcal
