// Covariance of what a fit found, with names.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace modcal {

/// Covariance of P parameters, in the units of their names (unit_of_parameter); those of a further
/// record have its number behind them, "x_c 2". Nothing of what is held.
struct NamedCovariance {
  std::vector<std::string> names;
  Eigen::MatrixXd matrix;  ///< P × P

  std::size_t size() const { return names.size(); }
  std::optional<std::size_t> find(std::string_view name) const;
  /// √ of a diagonal entry; NaN where that is below zero: less is told than the noise hides.
  double deviation(std::size_t i) const;
  /// The names whose deviation is NaN.
  std::vector<std::string> unknown() const;
  /// r_ij = C_ij/(s_i s_j), 1 on the diagonal; 0 beside what has no variance.
  Eigen::MatrixXd correlations() const;
  /// Singular values of the whitened Jacobian in units of the standard deviations, the roots of the
  /// eigenvalues of R⁻¹, largest first: each is how many times better a combination of parameters
  /// is known than they would be if all were independent. All 1 without correlations; infinite for
  /// a combination that is known exactly.
  std::vector<double> singular_values() const;
  /// Largest over smallest singular value; 1 without parameters.
  double condition() const;
  /// What is said of a parameter beyond the fit is independent of all others: it raises the
  /// variance to deviation², never lowers it.
  void raise(std::string_view name, double deviation);
};

/// Two parameters and their correlation.
struct CorrelatedPair {
  std::size_t first = 0, second = 0;
  double correlation = 0.0;
};

/// The `count` largest |r_ij| among the parameters taken, largest first; taken: one flag for each.
std::vector<CorrelatedPair> strongest_correlations(const NamedCovariance& covariance,
                                                   const std::vector<bool>& taken,
                                                   std::size_t count);

}  // namespace modcal
