// The unknowns of a likelihood fit: the law's or every frequency apart, contact, damping, sensors.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// One number that may be free, fixed at its value, or free under a Gaussian prior about it.
struct UnknownOption {
  bool free = false;
  double value = 0.0;  ///< start, and mean of the prior
  /// Standard deviation of the prior; NaN: none.
  double deviation = std::numeric_limits<double>::quiet_NaN();
};

/// What is unknown of the damping and of the sensor at x = L beside frequencies and contact.
struct UnknownsOptions {
  /// "fixed": ζ_n as stated; "factor": times one factor; "power": times a factor and a power of n;
  /// "each": every ζ_n, under a prior about the stated one.
  std::string damping = "factor";
  double damping_width = 0.3;        ///< sd of the prior of each ln ζ_n, with "each" [1]
  UnknownOption gain{.value = 1.0};  ///< of the sensor at x = L over that at x = 0 [1]
  UnknownOption delay;               ///< [s]
  UnknownOption corner;              ///< [Hz]
  /// Correlation of the priors of gain and delay, in (−1, 1) [1].
  double gain_delay_correlation = 0.0;
  void visit(OptionVisitor& visitor);
  SensorPair sensors() const;  ///< start
};

/// θ = (ln f_0, B | δ_1 … δ_N, x_c, damping, sensors) about a reference model, all zero there save
/// B: with the law ω_n = 2πn f_0 √(1 + B n²), else ω_n = ω_n(reference) exp(δ_n). Damping: nothing,
/// (ln factor), (ln factor, exponent) with ζ_n = ζ_n(reference) factor n^exponent, or every
/// ln ζ_n/ζ_n(reference); "each" is "factor" as long as the law holds. Sensors: those free of
/// ln gain, delay [s], corner [rad/s], as changes.
class StringUnknowns {
 public:
  StringUnknowns() = default;
  /// Law with f_0 [Hz] and B [1]; contact, damping and sensors of the reference.
  static StringUnknowns law(const ModelPoint& reference, double fundamental, double inharmonicity,
                            const UnknownsOptions& options = {});
  static StringUnknowns frequencies(const ModelPoint& reference,
                                    const UnknownsOptions& options = {});
  /// Frequencies and contact alone.
  StringUnknowns without_damping_and_sensors() const;

  bool is_law() const { return law_; }
  Eigen::Index size() const { return sensor_begin() + sensor_count(); }
  Eigen::Index contact() const { return law_ ? 2 : static_cast<Eigen::Index>(modes()); }
  Eigen::Index damping() const { return contact() + 1; }  ///< first of the damping's unknowns
  Eigen::Index damping_count() const;
  Eigen::Index sensor_begin() const { return damping() + damping_count(); }
  /// Place of ln gain (0), delay (1) or corner (2); -1 where it is not free.
  Eigen::Index sensor(std::size_t which) const;
  std::size_t modes() const { return reference_.basis.size(); }
  Eigen::VectorXd start() const;
  /// f_0 at θ, with the law [Hz].
  double fundamental(const Eigen::VectorXd& theta) const;
  /// Geometric mean of ζ_n over that of the reference.
  double damping_factor(const Eigen::VectorXd& theta) const;
  /// Its standard deviation, relative.
  double damping_deviation(const Eigen::MatrixXd& covariance) const;
  /// False where the law, the contact, damping or sensors leave what a string can be.
  bool admits(const Eigen::VectorXd& theta) const;
  ModelPoint model(const Eigen::VectorXd& theta) const;
  LikelihoodColumns columns(const Eigen::VectorXd& theta) const;
  /// Precision of the priors of damping and sensors, all of θ; `frequencies`: that of δ, or empty.
  Eigen::MatrixXd prior(const Eigen::MatrixXd& frequencies = {}) const;
  /// θ the prior is about.
  Eigen::VectorXd prior_mean() const;

 private:
  enum class Damping { kFixed, kFactor, kPower, kEach };
  Damping damping_kind() const;
  const UnknownOption& sensor_option(std::size_t which) const;
  Eigen::Index sensor_count() const;
  double sensor_change(std::size_t which, const Eigen::VectorXd& theta) const;
  double damping_change(std::size_t mode, const Eigen::VectorXd& theta) const;

  ModelPoint reference_;
  UnknownsOptions options_;
  double fundamental_ = 0.0;
  double inharmonicity_ = 0.0;
  bool law_ = false;
};

/// Precision of δ under δ_n = law's change + N(0, τ_n²), the law's change (ln f_0, B) unknown:
/// W − WL(LᵀWL)⁻¹LᵀW with W = diag(τ_n⁻²), L_n = (1, ½n²/(1 + B n²)).
Eigen::MatrixXd law_prior(const Eigen::VectorXd& widths, double inharmonicity);

}  // namespace modcal
