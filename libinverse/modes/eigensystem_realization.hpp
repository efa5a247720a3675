// Poles of a free decay from the shift structure of its samples.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "libinverse/modes/decay_record.hpp"

namespace modcal {

/// Eigensystem realization algorithm (Juang and Pappa, 1985): with the Hankel matrices
/// H_s[(i, c), j] = y_c(t_{i + qj + s}) and the singular values H_0 = U Σ Vᵀ, the model of order n
/// is A_n = Σ_n^−½ U_nᵀ H_1 V_n Σ_n^−½, whose eigenvalues are exp(λ/f_s). q spreads the columns
/// over the record. Prepared once for all orders; const.
class EigensystemRealization {
 public:
  /// block_rows: samples in a column, which span the longest beat that is told apart. The mean of
  /// every channel is taken out first. Throws InvalidInput for an invalid record or one shorter
  /// than twice block_rows, no block row, no column.
  EigensystemRealization(const DecayRecord& record, std::size_t block_rows, std::size_t columns);

  /// Singular values of H_0 in descending order: a noise-free decay of N modes has 2N.
  const Eigen::VectorXd& singular_values() const { return sigma_; }
  std::size_t highest_order() const { return static_cast<std::size_t>(sigma_.size()); }

  /// Poles of the model of an order with frequency > 0, in ascending order of frequency; poles on
  /// the real axis are no oscillation and are left out. 1 ≤ order ≤ highest_order(). Directions in
  /// which H_0 is zero to rounding are left out.
  std::vector<DecayPole> poles(std::size_t order) const;

 private:
  double sample_rate_;
  Eigen::VectorXd sigma_;
  Eigen::MatrixXd shifted_;  // Uᵀ H_1 V
};

}  // namespace modcal
