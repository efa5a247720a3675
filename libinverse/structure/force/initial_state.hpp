// What a structure rings of before the record begins.
#pragma once

#include <Eigen/Core>

#include "libinverse/structure/bin_evidence.hpp"

namespace modcal {

/// Free decays of the modes, of unknown real and imaginary parts c_n common to all sensors, which
/// also stand for what the record's end cuts off: Y_k = H_k F + Σ_n (r_kn c_n U_n + conj(r_kn c_n)
/// U'_n), U_n = 1/(1 − exp((λ_n − s)/f_s)), r_kn the residue of sensor k (strike_columns.hpp).
class InitialState {
 public:
  InitialState(const ModalModel& model, const ContourSpectra& spectra);

  struct Fit {
    Eigen::VectorXd state;  ///< c, two a mode
    Eigen::MatrixXd root;   ///< c is known to root · standard normal numbers
    double gain = 0.0;      ///< ln p(data) over that of rest
    double squares = 0.0;   ///< yᴴ S⁻¹ y of rest, twice the gain more than what c leaves
  };

  /// c of largest likelihood, the force being of `power` E|F|² in every bin: S = P h hᴴ + V, the
  /// others of theirs (BinVariances::others). Of largest posterior probability where c has such
  /// `widths`; empty: nothing is known of it.
  Fit fit(const Transfers& transfers, const BinVariances& variances,
          const std::vector<double>& power, const Eigen::VectorXd& widths = {}) const;

  /// Deviations of c where the modes of the only sensor ring with this rms in all [unit of the
  /// sensor]: each has the share of the response's power that its bins have.
  Eigen::VectorXd widths_of(double rms) const;

  /// Responses without what c rings.
  Transfers without(const Eigen::VectorXd& state) const;

  /// Whether a fit tells that the structure rang: more than BIC asks for 2N unknowns.
  bool is_told(const Fit& fit) const;

 private:
  using Columns = Eigen::MatrixXcd;  // bins x 2N
  const ContourSpectra& spectra_;
  std::vector<Columns> columns_;           // K
  std::vector<double> omegas_, residues_;  // of the modes: ω [rad/s], |r| of the first sensor
};

}  // namespace modcal
