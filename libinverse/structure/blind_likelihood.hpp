// The likelihood of K responses when the force of every bin is eliminated.
#pragma once

#include <Eigen/Core>

#include "libinverse/structure/bin_evidence.hpp"
#include "libinverse/structure/blind_kernel.hpp"
#include "libinverse/structure/column_span.hpp"

namespace modcal {

/// A model with the force and the end state that explain most, and what they leave.
struct BlindPoint {
  BlindBins bins;
  std::vector<double> told;            ///< |h|²
  std::vector<EndShapes> ends_shapes;  ///< of every mode; none: at rest
  ColumnSpan span;                     ///< of PX; empty: at rest
  Eigen::VectorXd ends;                ///< c: real and imaginary part of every mode
  Eigen::MatrixXd ends_root;   ///< c has the covariance of this times standard normal numbers
  Eigen::VectorXd residual;    ///< e = P (y − X c), a column of BlindBins
  std::vector<Complex> force;  ///< F of every bin
  double cost = 0.0;           ///< 2|e|²/κ
};

/// P = I − h hᴴ/|h|², whitened by V; X holds r_kn c_n U_n + conj(r_kn c_n) U'_n, what rings at the
/// record's begin and end (strike_columns.hpp), c common to all sensors. e has K numbers a bin, of
/// rank K − 1.
class BlindLikelihood {
 public:
  /// All but at_rest must outlive this. The models must have a quadrature.
  BlindLikelihood(const ContourSpectra& spectra, const std::vector<SensorKind>& kinds,
                  const BinVariances& variances, bool at_rest);

  BlindPoint at(const ModalModel& model) const;
  /// Derivatives of e by ln f and ln ζ of the modes, then, if they are free, by real and imaginary
  /// part of factors 1 + d of the modal constants of `start`: −P (dh F + dX c), off PX. The other
  /// half of dP y lies along h, orthogonal to e.
  Eigen::MatrixXd jacobian(const ModalModel& start, const ModalModel& model,
                           const BlindPoint& point, bool factors) const;
  /// The force of every bin as the data allow it, where the model is right: c moved by its
  /// deviation times standard normal numbers, two a mode, F by that of its noise, CN(0, 1/|h|²),
  /// two a bin behind them. On the frequency axis: bins of a contour are not independent.
  std::vector<Complex> force_drawn(const ModalModel& model, std::span<const double> normal) const;
  /// The responses without what rings at the record's begin and end, K.
  Transfers without_ends(const ModalModel& model, const BlindPoint& point) const;
  double correlated() const { return spectra_.correlated(); }
  /// Numbers that the data have when the force is eliminated, 2B(K − 1)/κ.
  double numbers() const;

 private:
  using Signals = std::vector<PlanarVector>;  // of every sensor, whitened

  std::size_t bins() const { return spectra_.count(); }
  std::size_t sensors() const { return data_.size(); }
  BlindBins bins_of(const ModalModel& model, std::vector<double>& told) const;
  Signals rest() const;
  Signals slope_of_ends(const BlindPoint& point, const ModalModel& model, std::size_t n,
                        bool damping) const;
  void mode_columns(const ModalModel& start, const ModalModel& model, const BlindPoint& point,
                    std::size_t n, bool factors, Eigen::MatrixXd& result) const;
  void take_ends(const ModalModel& model, const BlindPoint& point, const Eigen::VectorXd& ends,
                 Signals& data) const;
  void fit_ends(const ModalModel& model, BlindPoint& point, Signals& data) const;
  std::vector<Complex> force_of(const BlindPoint& point, const Signals& data) const;

  const ContourSpectra& spectra_;
  const std::vector<SensorKind>& kinds_;
  bool free_ends_;
  PlanarVector s_, turned_, delay_;   // s, −1/s, exp(−s/f_s)
  std::vector<AlignedVector> roots_;  // 1/√V, K
  Signals data_;                      // the responses
};

}  // namespace modcal
