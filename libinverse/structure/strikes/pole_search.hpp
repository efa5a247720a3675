// Least squares over poles with the linear unknowns of every sensor eliminated.
#pragma once

#include <Eigen/Core>

#include "libinverse/structure/strikes/strike_columns.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {

/// One sensor at given poles: y = M x + r, columns of unit norm.
struct SensorFit {
  Eigen::MatrixXd columns;  ///< weighted; real over imaginary parts
  Eigen::VectorXd norms;    ///< of the columns before
  SemidefiniteSolver gram;
  Eigen::VectorXd amplitudes;  ///< of the columns as they are
  Eigen::VectorXd residual;

  double cost() const { return residual.squaredNorm(); }
  /// What of v no column takes.
  Eigen::MatrixXd project(const Eigen::MatrixXd& v) const {
    return v - columns * gram.solve(columns.transpose() * v);
  }
};

/// A strike that a search looks at; all must outlive it.
struct SearchedStrike {
  const ContourSpectra& spectra;
  std::span<const double> force;                    ///< samples [N]
  const std::vector<std::vector<double>>& weights;  ///< 1/σ of every bin, by sensor
};

/// White noise in the samples of a measured force, which all sensors seem to answer: each is off by
/// −H_k N in every bin.
struct ForceNoise {
  double deviation = 0.0;                                    ///< [N]; 0: none is seen
  std::vector<std::vector<std::vector<Complex>>> transfers;  ///< H_k at the bins, by strike
};

class PoleSearch {
 public:
  /// Strikes at one place, on one contour: they have all poles and modal constants in common.
  /// grid_numbers: the grid looks at as many strikes as these hold, and at one at least.
  PoleSearch(std::span<const SearchedStrike> strikes, const std::vector<SensorKind>& kinds,
             double grid_numbers = kGridNumbers);

  std::vector<SensorFit> at(const std::vector<ModalPole>& poles) const;
  double cost(const std::vector<ModalPole>& poles) const;
  /// Fits the poles by at most `steps` of Levenberg and Marquardt; returns the cost.
  double fit(std::vector<ModalPole>& poles, int steps) const;
  /// Of the pairs of poles on a grid over the band the one that takes most from the cost.
  ModalPole best_addition(const std::vector<ModalPole>& poles);
  /// Slopes of every sensor's residual by ln f and ln ζ of each mode in turn, the linear unknowns
  /// eliminated, K; fits: those at the poles.
  std::vector<Eigen::MatrixXd> jacobians(const std::vector<ModalPole>& poles,
                                         const std::vector<SensorFit>& fits) const;
  /// Covariance A⁻¹ (Σ_k Jᵀ V J + S_k) A⁻¹ of ln f and ln ζ by the slopes J of jacobians(), A = Σ
  /// JᵀJ (White, 1980), where the weighted residuals of sensor k have these variances, one a bin of
  /// every strike in turn, of independent bins, and a sample has white noise of this deviation:
  /// what J takes from exp(−σt) noise. That of the force is taken by all sensors together. Weights
  /// that are off cost sharpness, not honesty.
  Eigen::MatrixXd covariance(const std::vector<Eigen::MatrixXd>& slopes,
                             const std::vector<Eigen::VectorXd>& variances,
                             std::span<const double> noise, const ForceNoise& force) const;
  /// Σ_k (A⁻¹ J_kᵀ r_k)², how far the sensors pull ln f and ln ζ of each mode apart (the sandwich
  /// with a cluster a sensor; Liang and Zeger, 1986). What is one mode pulls them no further than
  /// its residuals have it; two that are taken for one have another share in every sensor.
  Eigen::VectorXd variance_between(const std::vector<Eigen::MatrixXd>& slopes,
                                   const std::vector<SensorFit>& fits) const;
  /// Static terms of a sensor: powers of s besides its own, −2 and 0 (an acceleration, a velocity)
  /// or −2 and 0 (a displacement).
  static constexpr Eigen::Index kStatics = 2;
  std::size_t sensors() const { return kinds_.size(); }

 private:
  using Columns = std::vector<std::array<ColumnPair, 3>>;  // of a pair of poles, by strike
  struct Strike {
    const ContourSpectra& spectra;
    StrikeColumns columns;
    const std::vector<std::vector<double>>& weights;
    Eigen::Index first;  // of its rows: real over imaginary parts
    Eigen::Index rows() const { return 2 * static_cast<Eigen::Index>(spectra.count()); }
  };
  struct Promise {
    Eigen::Matrix2d kept;
    Eigen::Vector2d score;
  };
  static std::size_t power_index(SensorKind kind) {
    return static_cast<std::size_t>(power_of_s(kind));
  }
  struct Equations {
    Eigen::MatrixXd matrix;  // JᵀJ
    Eigen::VectorXd slope;   // Jᵀr
  };
  Columns columns_of(const ModalPole& pole) const;
  /// Slopes of a sensor at the bins of a strike, complex, times their weights.
  Eigen::MatrixXcd weighted_slopes(const Strike& strike, std::size_t k,
                                   const Eigen::MatrixXd& slopes) const;
  Equations equations(const std::vector<ModalPole>& poles) const;
  SensorFit sensor_at(std::size_t k, const std::vector<Columns>& columns,
                      const std::vector<ModalPole>& poles) const;
  void weigh(const Strike& strike, std::size_t k, const std::vector<Complex>& spectrum,
             Eigen::Ref<Eigen::VectorXd> rows) const;
  Eigen::VectorXd weighted(std::size_t k, const Columns& columns, bool turned) const;
  void lay_grid();
  Promise exact(std::size_t k, std::size_t i, const Columns& columns, const SensorFit& fit) const;
  void take_last(const std::vector<SensorFit>& fits);

  std::vector<Strike> strikes_;
  double grid_numbers_;
  Eigen::Index rows_ = 0;
  const std::vector<SensorKind>& kinds_;
  std::array<bool, 3> powers_ = {false, false, false};
  std::vector<Eigen::VectorXd> data_;    // weighted, K
  std::vector<Eigen::MatrixXd> static_;  // weighted columns, K
  std::vector<ModalPole> grid_;
  Eigen::Index grid_rows_ = 0;                      // of the first strikes
  std::vector<Eigen::MatrixXd> grid_columns_;       // two a pole, K
  std::vector<std::vector<Eigen::Matrix2d>> kept_;  // about: what they keep beside the others, K
};

}  // namespace modcal
