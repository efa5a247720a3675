#include "libsim/base/dense_solvers.hpp"

#include <Eigen/SVD>
#include <algorithm>

template class Eigen::HouseholderQR<Eigen::MatrixXd>;
template class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
template class Eigen::LDLT<Eigen::MatrixXd>;
template class Eigen::LLT<Eigen::MatrixXd>;
template class Eigen::PartialPivLU<Eigen::MatrixXd>;
template class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

namespace modcal {
namespace {

struct Orthogonal {
  Orthogonal(const Eigen::MatrixXd& matrix, double threshold) {
    solver.setThreshold(threshold);
    solver.compute(matrix);
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
};

}  // namespace

template <typename Factor>
SymmetricSolver<Factor>::SymmetricSolver(const Eigen::MatrixXd& matrix) : factor_(matrix) {}

template <typename Factor>
Eigen::VectorXd SymmetricSolver<Factor>::vector(const Eigen::VectorXd& right) const {
  return factor_.solve(right);
}

template <typename Factor>
Eigen::MatrixXd SymmetricSolver<Factor>::columns(const Eigen::MatrixXd& right) const {
  if (right.size() == 0) return right;  // Eigen would ask for its first number
  return factor_.solve(right);
}

template class SymmetricSolver<Eigen::LDLT<Eigen::MatrixXd>>;
template class SymmetricSolver<Eigen::LLT<Eigen::MatrixXd>>;

Eigen::MatrixXd whiten(const PositiveSolver& solver, const Eigen::MatrixXd& right) {
  return solver.factor().matrixL().solve(right);
}

Eigen::VectorXd whiten(const PositiveSolver& solver, const Eigen::VectorXd& right) {
  return solver.factor().matrixL().solve(right);
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
  return matrix.selfadjointView<Eigen::Lower>().eigenvalues();
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
}

ThinSvd::ThinSvd(const Eigen::MatrixXd& a) {
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
  left = svd.matrixU();
  values = svd.singularValues();
  right = svd.matrixV();
}

GeneralizedEigen generalized_eigen(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  // Eigen's own solver takes any B.
  if (PositiveSolver(b).factor().info() != Eigen::Success) return {};
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(a, b);
  if (solver.info() != Eigen::Success) return {};
  return {.found = true, .values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                    double threshold) {
  return Orthogonal(a, threshold).solver.solve(b);
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& a, double threshold) {
  return Orthogonal(a, threshold).solver.pseudoInverse();
}

Eigen::MatrixXd solve_general(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXd ThinQr::q() const {
  return factor.householderQ() * Eigen::MatrixXd::Identity(factor.rows(), factor.cols());
}

Eigen::MatrixXd ThinQr::r() const {
  return factor.matrixQR().topRows(factor.cols()).triangularView<Eigen::Upper>();
}

Eigen::VectorXd ThinQr::solve(const Eigen::VectorXd& right) const { return factor.solve(right); }
Eigen::MatrixXd ThinQr::solve(const Eigen::MatrixXd& right) const { return factor.solve(right); }

}  // namespace modcal
