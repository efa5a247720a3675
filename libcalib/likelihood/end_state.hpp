// The linear unknowns of the joint likelihood: what the record leaves ringing, or its offsets.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "libcalib/likelihood/decay_kernel.hpp"

namespace modcal {

/// At σ = 0 the complex amplitudes c_n of the sampled free decays (2N columns x_n, x'_n, see
/// decay_kernel.hpp), for σ > 0 the static offsets of both records. Least squares by the normal
/// equations, columns normalized, ridge 1e-9. The Gram matrix of the decays takes one sum a mode
/// and parity, since with |z| = 1
///
///     conj(U_m) U_n = (conj(U_m) + U_n − 1)/(1 − conj(E_m) E_n).
class EndState {
 public:
  /// `modes` must outlive this.
  EndState(const WhitenedRecord& record, std::span<const LikelihoodMode> modes);

  bool decays() const { return decays_; }
  std::size_t size() const { return size_; }
  /// First pass over one block; `offsets`: the two columns of offsets, unless decays().
  void add(const WhitenedRecord& record, std::size_t block_index, const LikelihoodBlock& block,
           const double* residual, const double* offsets);
  /// Finds the unknowns of least squares.
  void solve();

  std::span<const Complex> amplitudes() const { return amplitudes_; }  ///< c_n, where decays()
  std::array<double, 2> offset() const { return offset_; }
  /// (XᵀX)⁻¹ B for the columns X.
  Eigen::MatrixXd fit(const Eigen::MatrixXd& products) const;

 private:
  std::span<const LikelihoodMode> modes_;
  bool decays_;
  std::size_t size_;
  std::vector<DecayPowers> powers_;
  DecayTotals totals_;
  Eigen::MatrixXd gram_;
  Eigen::VectorXd products_;  // with the residual
  Eigen::VectorXd inverse_norms_;
  Eigen::LLT<Eigen::MatrixXd> normal_;
  std::vector<Complex> amplitudes_;
  std::array<double, 2> offset_{};
};

}  // namespace modcal
