// Dense linear algebra that several rooms need, compiled once: each of Eigen's decompositions costs
// every file that names it seconds.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

// The members of these are compiled in dense_solvers.cpp alone.
extern template class Eigen::HouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
extern template class Eigen::LDLT<Eigen::MatrixXd>;
extern template class Eigen::LLT<Eigen::MatrixXd>;
extern template class Eigen::PartialPivLU<Eigen::MatrixXd>;
extern template class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

namespace modcal {

/// A factor of a symmetric matrix, of which the lower triangle is read, by one of Eigen's: solves
/// AX = B column by column.
template <typename Factor>
class SymmetricSolver {
 public:
  SymmetricSolver() = default;
  explicit SymmetricSolver(const Eigen::MatrixXd& matrix);
  /// Of what Eigen's own solve() would give, the plain matrix or vector.
  template <typename Right>
  auto solve(const Eigen::MatrixBase<Right>& right) const {
    if constexpr (Right::ColsAtCompileTime == 1) {
      return vector(right);
    } else {
      return columns(right);
    }
  }
  const Factor& factor() const { return factor_; }

 private:
  Eigen::VectorXd vector(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd columns(const Eigen::MatrixXd& right) const;
  Factor factor_;
};

/// A = PᵀLDLᵀP, semidefinite.
using SemidefiniteSolver = SymmetricSolver<Eigen::LDLT<Eigen::MatrixXd>>;
/// A = LLᵀ, positive definite; factor().info() says where it is not.
using PositiveSolver = SymmetricSolver<Eigen::LLT<Eigen::MatrixXd>>;

/// L⁻¹B of A = LLᵀ.
Eigen::MatrixXd whiten(const PositiveSolver& solver, const Eigen::MatrixXd& right);
Eigen::VectorXd whiten(const PositiveSolver& solver, const Eigen::VectorXd& right);

/// Ascending, of a symmetric matrix, of which the lower triangle is read.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

/// Of a square matrix, in no order.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// A = U diag(σ) Vᵀ with the columns of U and V that σ has.
struct ThinSvd {
  explicit ThinSvd(const Eigen::MatrixXd& a);
  Eigen::MatrixXd left;    ///< U
  Eigen::VectorXd values;  ///< σ, descending
  Eigen::MatrixXd right;   ///< V
};

/// Ax = λBx with xᵀBx = 1, A symmetric and B positive definite.
struct GeneralizedEigen {
  bool found = false;
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< as columns
};
GeneralizedEigen generalized_eigen(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// Of all x with least ‖Ax − b‖ that of least norm; pivots below `threshold` of the largest are 0.
Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                    double threshold);
/// That X for B = 1.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a, double threshold);

/// A⁻¹B by LU.
Eigen::MatrixXd solve_general(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// A = QR, no fewer rows than columns: the columns of Q that span A, and the least squares.
struct ThinQr {
  explicit ThinQr(const Eigen::MatrixXd& a) : factor(a) {}
  Eigen::MatrixXd q() const;
  Eigen::MatrixXd r() const;
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  Eigen::HouseholderQR<Eigen::MatrixXd> factor;
};

}  // namespace modcal
