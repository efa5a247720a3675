// How sharply a least-squares optimum is determined.
#pragma once

#include <span>
#include <vector>

#include "libcalib/problem/objective_function.hpp"
#include "libcalib/problem/variable.hpp"

namespace modcal {

/// Covariance of the parameters at an optimum, (JᵀJ)⁻¹ for residuals whitened to variance 1.
struct Covariance {
  bool full_rank = false;      ///< false: some combination of parameters moves no residual
  std::size_t size = 0;        ///< number of parameters n
  std::vector<double> matrix;  ///< n × n, row-major, in user units; empty unless full_rank

  double operator()(std::size_t i, std::size_t j) const { return matrix[i * size + j]; }
  /// √ of a diagonal entry; NaN unless full_rank.
  double standard_deviation(std::size_t i) const;
};

/// (JᵀJ)⁻¹ at x by a singular value decomposition of the scaled Jacobian (Ceres Solver); singular
/// values below 1e-14 of the largest count as 0. J built from noisy data counts noise as
/// information: right where the residuals are linear in the noise, small where they are not.
/// Throws InvalidInput where the objective has no residuals or the point lies outside the bounds.
Covariance covariance_at(const ObjectiveFunction& function, std::span<const Variable> variables,
                         std::span<const double> x);

/// Roots of the diagonal of (information + prior)⁻¹ at x (ObjectiveOutputs), in user units; ∞ where
/// a direction of which both tell nothing (eigenvalues below 1e-14 of the largest, each parameter
/// in units of its own information) holds more than 1e-6 of a parameter. Throws InvalidInput where
/// the objective has no information.
std::vector<double> deviations_by_information(const ObjectiveFunction& function,
                                              std::span<const double> x);

}  // namespace modcal
