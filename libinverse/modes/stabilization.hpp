// Poles of a free decay from the shift structure of its samples, and which of them are modes.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libinverse/modes/decay_record.hpp"
#include "libsim/base/options.hpp"

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

struct StabilizationOptions {
  std::int64_t lowest_order = 2;
  std::int64_t highest_order = 60;
  double frequency_tolerance = 2e-3;  ///< change of f between orders, relative [1]
  double damping_tolerance = 1e-3;    ///< change of ζ between orders, absolute [1]
  std::int64_t required = 6;          ///< orders in a row that a mode must be stable
  double highest_damping = 0.2;       ///< a pole with more is no mode of a string [1]
  void visit(OptionVisitor& visitor);
};

/// One pole of one order.
struct StabilizationPoint {
  std::size_t order = 0;
  DecayPole pole;
  /// Orders in a row, this one included, over which it has moved less than the tolerances.
  std::int64_t stable_orders = 0;
};

/// Poles of the even orders from lowest to highest, or to the highest that the realization has.
std::vector<StabilizationPoint> stabilization_diagram(const EigensystemRealization& realization,
                                                      const StabilizationOptions& options);

/// A pole of the last order that has been stable for as long as required, with the standard
/// deviation of f and ζ over those orders: how far the choice of the order matters, which is not
/// how far noise does.
struct StablePole {
  DecayPole pole;
  DecayPole spread;
};
std::vector<StablePole> stable_poles(const std::vector<StabilizationPoint>& diagram,
                                     const StabilizationOptions& options);

}  // namespace modcal
