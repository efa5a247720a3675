// A table's modes refined by the responses of K sensors to a force that nobody measured.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "libinverse/structure/bin_evidence.hpp"
#include "libinverse/structure/structure_table.hpp"

namespace modcal {

/// The unknowns are, for mode n, ln f_n and ln ζ_n, then Re d_kn and Im d_kn, A_kn → A_kn (1 +
/// d_kn), of every sensor and mode in turn.
struct BlindFit {
  ModalModel model;
  Eigen::VectorXd change;      ///< θ from the table
  Eigen::MatrixXd covariance;  ///< of θ
  Eigen::MatrixXd root;        ///< covariance = root rootᵀ
  Eigen::VectorXd prior;       ///< deviations of θ before the responses
  StructureChange allowed;     ///< of which these are, without what the table itself does not know
  Eigen::VectorXd told;        ///< share of θ_i that the responses tell, by the curvature
  Eigen::VectorXd expected;    ///< deviation of θ where the prior is right
  double numbers = 0.0;        ///< 2B(K − 1)/κ, what the data are worth
  double degrees = 0.0;        ///< of these less what c and θ take
  /// 2|e|² over its degrees of freedom; NaN: there is none.
  double misfit = std::numeric_limits<double>::quiet_NaN();
  Transfers between;                   ///< responses without what rings at the record's ends, K
  std::vector<Complex> force;          ///< F of every bin
  std::vector<double> force_variance;  ///< of |F|², noise alone

  /// θ_i over what the prior expects of it, ~ N(0, 1) where that is right; NaN: told by less than a
  /// half.
  double surprise(Eigen::Index i) const;
  /// By how much more than the others every sensor reads all modes, the mean of Re d_kn weighted by
  /// told_kn/sd_kn², less that of all sensors; 0: constants are known.
  std::vector<double> gains() const;
  /// A model as the data allow it: θ moved by covariance^½ times standard normal numbers, one an
  /// unknown.
  ModalModel drawn(std::span<const double> normal) const;
};

/// Least of J = 2|e|²/κ + Σ θ_i²/sd_i², e = P (y − X c): y the responses whitened by V, P = I − h
/// hᴴ/|h|² without the force of every bin, c what rings at the record's begin and end, common to
/// all sensors (unless the structure rests and the contour leaves nothing of the end). Levenberg
/// and Marquardt with the Jacobian −P (dh F + dX c), projected off PX. A factor common to all d_kn
/// is the scale of the force: the responses do not see it. start_at: θ to begin with, empty: 0.
/// Throws InvalidInput for K < 2: one response explains any model.
BlindFit fit_blindly(const ModalModel& table, const ContourSpectra& spectra,
                     const BinVariances& variances, const StructureChange& change, bool at_rest,
                     const Eigen::VectorXd& start_at = {});

/// The fit of a record that rings when it begins, with white noise of these deviations a sensor: on
/// the contours 40, 20, 10, 5 and 0 [1/s], each from what the one before has found, the state at
/// the record's ends unknown. low, high: band [Hz].
BlindFit fit_ringing(const ModalModel& table, const StructureRecord& record,
                     std::span<const double> noise, double low, double high,
                     const StructureChange& change);

/// The fit of a record that begins at rest: on the contours σ, σ/2 and σ/4, the lower ones as far
/// as the record is long enough for nothing to be left of its end, and on the last one until the
/// variances of its bins have settled, each from what the one before has found, with variances_of()
/// the model so far. A change whose size is found has it settled, too: sd² → sd² Σ θ²/sd² ÷ Σ told
/// of frequencies, damping ratios and constants (MacKay, 1992), within kLeastChange and
/// kMostChange. The covariance is χ² times as large where it is above 1. The table is not changed.
BlindFit refined_table(const StructureTable& table, const StructureRecord& record, double sigma,
                       const StructureChange& change, bool at_rest = true);

}  // namespace modcal
