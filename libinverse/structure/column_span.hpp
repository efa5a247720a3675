// What tall columns span, and data without it.
#pragma once

#include <Eigen/Core>

#include "libsim/base/aligned_vector.hpp"

namespace modcal {

/// AᵀA of tall columns.
Eigen::MatrixXd square_of(const Eigen::MatrixXd& columns);

/// The columns of A, rows × n, rows ≫ n: AᵀA = RᵀR, an orthonormal basis A R⁻¹ of what they span.
/// Where a column has less than kOwnOfColumn of its own, by reflections (Householder, 1958).
class ColumnSpan {
 public:
  ColumnSpan() = default;
  explicit ColumnSpan(const Eigen::MatrixXd& columns);

  bool empty() const { return root_.size() == 0; }
  /// y ← y − A c with the c of least |y − A c|, which it returns.
  Eigen::VectorXd take_from(Eigen::VectorXd& y) const;
  /// The same of every column.
  void take_from(Eigen::MatrixXd& columns) const;
  /// R⁻¹: of data with independent errors of variance 1, c has the covariance R⁻¹ R⁻ᵀ.
  const Eigen::MatrixXd& root() const { return root_; }
  Eigen::MatrixXd basis() const;

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void pack(const Eigen::MatrixXd& columns);
  /// AᵀB of the packed columns and others.
  Rows products(const Eigen::MatrixXd& others) const;
  /// others −= A factors.
  void subtract(const Rows& factors, Eigen::MatrixXd& others) const;

  Eigen::Index rows_ = 0;
  AlignedVector packed_;  ///< blocks of kColumnLength rows, a padded number of columns each
  Eigen::MatrixXd orthogonal_, root_;
};

}  // namespace modcal
