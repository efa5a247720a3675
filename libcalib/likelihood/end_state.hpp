// The linear unknowns of the joint likelihood: what the record leaves ringing, or its offsets.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "libcalib/likelihood/kernels/decay_kernel.hpp"
#include "libcalib/parameters/parameter_table.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {

/// Something in the record of one end, known but for its real amplitude.
struct PlainTransient {
  bool right = false;
  PlanarVector numbers;  ///< its transform, whitened but for 1/s_r
  /// What is in the record of x = 0 where that at x = L is in `numbers`; empty: nothing.
  PlanarVector left = {};
  /// ∂numbers by the numbers of the sensor at x = L; empty: none.
  std::array<PlanarVector, Sensor::kCount> by_sensor = {};
};
/// σ > 0: static offsets of both records. σ = 0: where the sensor at x = L has a delay or a corner
/// of its own, or may have one, what it holds at the end of the record: one sample and its own
/// decay. Where there are modes above the stated ones, what these leave ringing, smooth in the
/// band: 1, s and s² at both ends; and the signals of the record. At any σ the cosine and sine of
/// every line of the mains, steady and growing in time: the mains wander, and F is known to a
/// fraction of 1/T.
std::vector<PlainTransient> plain_transients(const WhitenedRecord& record, const ModelPoint& point);

/// At σ = 0 the complex amplitudes c_n of the sampled free decays (2N columns x_n, x'_n, see
/// decay_kernel.hpp), and the amplitudes of plain transients behind them. Least squares by the
/// normal equations, columns normalized, ridge 1e-9. The Gram matrix of the decays takes one sum a
/// mode and parity, since with |z| = 1
///
///     conj(U_m) U_n = (conj(U_m) + U_n − 1)/(1 − conj(E_m) E_n).
class EndState {
 public:
  /// `modes` must outlive this. plain: how many plain transients there are.
  EndState(const WhitenedRecord& record, std::span<const LikelihoodMode> modes, std::size_t plain);

  /// Sums over some of the blocks.
  struct Sums {
    AlignedVector powers, products;  // lanes
    DecayTotals totals;
    Eigen::MatrixXd plain;  // products of residual and plain transients
  };

  std::size_t decays() const { return decays_; }  ///< modes that decay, the first; 0 for σ > 0
  std::size_t size() const { return 2 * decays_ + plain_; }
  /// Adds what the model alone decides, of one block.
  void add_gram(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                const LikelihoodBlock& block, Sums& sums) const;
  /// Adds products of `columns`: the residual, then those of the plain transients.
  void add_products(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                    const LikelihoodBlock& block, const double* columns, Sums& sums) const;
  /// Finds the unknowns of least squares from the sums over all blocks, added up in their order.
  void solve(std::span<const Sums> sums);
  /// The same for other data of the same model, from their products alone.
  void solve_again(std::span<const Sums> sums);

  std::span<const Complex> amplitudes() const { return amplitudes_; }  ///< c_n
  double plain_amplitude(std::size_t i) const { return plain_amplitudes_[i]; }
  /// (XᵀX)⁻¹ B for the columns X.
  Eigen::MatrixXd fit(const Eigen::MatrixXd& products) const;

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMatrix collect_products(const Sums& sums) const;
  void find(const Eigen::VectorXd& products);

  std::span<const LikelihoodMode> modes_;
  std::size_t decays_, plain_;
  Eigen::VectorXd inverse_norms_;
  PositiveSolver normal_;
  std::vector<Complex> amplitudes_;
  std::vector<double> plain_amplitudes_;
};

}  // namespace modcal
