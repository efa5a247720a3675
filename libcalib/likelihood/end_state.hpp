// The linear unknowns of the joint likelihood: what the record leaves ringing, or its offsets.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "libcalib/likelihood/kernels/decay_kernel.hpp"
#include "libcalib/likelihood/plain_transients.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {

/// At σ = 0 the complex amplitudes c_n of the sampled free decays (2N columns x_n, x'_n, see
/// decay_kernel.hpp), and the amplitudes a_p of plain transients behind them. Least squares by the
/// normal equations, columns normalized. The Gram matrix of the decays takes one sum a mode and
/// parity, since with |z| = 1
///
///     conj(U_m) U_n = (conj(U_m) + U_n − 1)/(1 − conj(E_m) E_n).
///
/// What an impulse of the force at the begin or the end of the record leaves ringing moves both
/// ends as the force does, and the residual hardly sees it. A prior holds these amplitudes, by
/// their energy over that of the record, E = Σ |y_1|² + |y_2|²:
///
///     R = Σ_n ρ_n |c_n|² + Σ_p ρ_p a_p²,
///     ρ_n = ρ N/(E s_1 s_2 (1 − |E_n|²)),  ρ_p = 1e-3 ρ Σ |u_p|²/2E.
///
/// It belongs to the cost: without it, half the cost's gradient would not be the slope Re Jᴴ W e.
class EndState {
 public:
  /// `modes` must outlive this.
  EndState(const WhitenedRecord& record, std::span<const LikelihoodMode> modes,
           std::span<const PlainTransient> plain);

  /// Sums over some of the blocks.
  struct Sums {
    AlignedVector powers, products;  // lanes
    DecayTotals totals;
    AlignedVector plain;   // products of the plain transients, the lower half, in rows
    Eigen::VectorXd left;  // of theirs with the residual
  };

  std::size_t decays() const { return decays_; }  ///< modes that decay, the first; 0 for σ > 0
  std::size_t size() const { return 2 * decays_ + plain_; }
  /// Adds what the model alone decides, of one block. plain: columns of the plain transients, room
  /// for tiled() of them.
  void add_gram(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                const LikelihoodBlock& block, const double* plain, Sums& sums) const;
  /// Adds products of `columns`: the residual, then those of the plain transients.
  void add_products(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                    const LikelihoodBlock& block, const double* columns, Sums& sums) const;
  /// Finds the unknowns of least squares from the sums over all blocks, added up in their order.
  void solve(std::span<const Sums> sums);
  /// The same for other data of the same model, from their products alone.
  void solve_again(std::span<const Sums> sums);

  std::span<const Complex> amplitudes() const { return amplitudes_; }  ///< c_n
  double plain_amplitude(std::size_t i) const { return plain_amplitudes_[i]; }
  double cost() const { return cost_; }  ///< R
  double slope(std::size_t n) const;  ///< ½ ∂R/∂ln ω_n = ½ ∂R/∂ln ζ_n at fixed amplitudes
  /// ∂√R of some unknowns. slope: ½ ∂R at fixed amplitudes; fit: fit() of the unknowns' products,
  /// which the amplitudes follow.
  Eigen::VectorXd root_slope(const Eigen::VectorXd& slope, const Eigen::MatrixXd& fit) const;
  /// (XᵀX + R'')⁻¹ B for the columns X.
  Eigen::MatrixXd fit(const Eigen::MatrixXd& products) const;

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMatrix collect_products(const Sums& sums) const;
  void find(const Eigen::VectorXd& products);

  std::span<const LikelihoodMode> modes_;
  std::size_t decays_, plain_;
  Eigen::VectorXd inverse_norms_, ridge_, found_;
  std::vector<double> ridge_slopes_;  // −∂ρ_n/∂ln ω_n
  double cost_ = 0.0;
  PositiveSolver normal_;
  std::vector<Complex> amplitudes_;
  std::vector<double> plain_amplitudes_;
};

}  // namespace modcal
