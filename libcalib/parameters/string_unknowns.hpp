// The unknowns of a likelihood fit: the law's or every frequency apart, contact, damping, sensors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "libcalib/parameters/free_parameters.hpp"
#include "libcalib/parameters/stated_priors.hpp"

namespace modcal {

/// θ = (ln f_0, B | δ_1 … δ_N, x_c, damping, sensors) about a reference model, all zero there save
/// B: with the law ω_n = 2πn f_0 √(1 + B n²), else ω_n = ω_n(reference) exp(δ_n). Damping: nothing,
/// (ln factor), (ln factor, exponent) with ζ_n = ζ_n(reference) factor n^exponent, or every
/// ln ζ_n/ζ_n(reference); "each" is "factor" as long as the law holds. Sensors: those free of
/// ln gain, delay [s], corner [rad/s], as changes; then the real and imaginary part of every knot
/// of their smooth response, where that is free, which have no names.
class StringUnknowns {
 public:
  StringUnknowns() = default;
  /// Law with f_0 [Hz] and B [1]; contact, damping and sensors of the reference.
  static StringUnknowns law(const ModelPoint& reference, double fundamental, double inharmonicity,
                            const UnknownsOptions& options = {}, const StatedPriors& priors = {});
  static StringUnknowns frequencies(const ModelPoint& reference,
                                    const UnknownsOptions& options = {},
                                    const StatedPriors& priors = {});
  /// Frequencies and contact alone.
  StringUnknowns without_damping_and_sensors() const;

  bool is_law() const { return law_; }
  const FreeParameters& parameters() const { return free_; }
  Eigen::Index size() const { return named() + 2 * static_cast<Eigen::Index>(knots_); }
  /// Unknowns that have a name, the first.
  Eigen::Index named() const { return static_cast<Eigen::Index>(free_.size()); }
  Eigen::Index contact() const { return law_ ? 2 : static_cast<Eigen::Index>(modes()); }
  Eigen::Index damping() const { return contact() + 1; }  ///< first of the damping's unknowns
  Eigen::Index damping_count() const { return damping_count_; }
  /// Those that a record has for itself where the options say so; only a stroke has a contact.
  std::vector<Eigen::Index> own_places(bool stroke) const;
  /// θ of another model: the law fitted to its frequencies, its contact and sensors, its damping by
  /// the mean change of the ratios that are not fixed.
  Eigen::VectorXd theta_of(const ModelPoint& model) const;
  /// Start of a stroke that was fitted by itself, as far as it is its own.
  Eigen::VectorXd own_start(const ModelPoint& found) const;
  /// Mean of ln ζ_n/ζ_n(from) over the damping ratios that are not fixed.
  double mean_damping_change(const ModelPoint& from, const ModelPoint& to) const;
  std::size_t modes() const { return reference_.basis.size(); }
  Eigen::VectorXd start() const;
  /// Whether unknown i keeps its start exactly; of a further record x_c alone is its own.
  bool held(Eigen::Index i, std::size_t record = 0) const;
  Eigen::Index held_count() const;
  /// Zero where an unknown is held.
  void clear_held(Eigen::MatrixXd& covariance) const;
  /// f_0 at θ, with the law [Hz].
  double fundamental(const Eigen::VectorXd& theta) const;
  /// Factor of ζ_n/ζ_n(reference), those aside that are held; with "each" their geometric mean.
  double damping_factor(const Eigen::VectorXd& theta) const;
  /// Exponent of n in ζ_n/ζ_n(reference).
  double damping_power(const Eigen::VectorXd& theta) const;
  double damping_power_deviation(const Eigen::MatrixXd& covariance) const;
  /// Relative standard deviation of every ζ_n, 0 where it is held; empty unless each is free.
  std::vector<double> ratio_deviations(const Eigen::MatrixXd& covariance) const;
  /// Standard deviation of the factor, relative.
  double damping_deviation(const Eigen::MatrixXd& covariance) const;
  /// Those of gain, delay [s] and corner [Hz] of the model; 0: not free.
  std::array<double, Sensor::kCount> sensor_deviation(const ModelPoint& model,
                                                      const Eigen::MatrixXd& covariance) const;
  /// Those of the real and imaginary parts of the knots of the response; empty: it is not free.
  std::vector<std::complex<double>> response_deviations(const Eigen::MatrixXd& covariance) const;
  /// The misfit of the response to its prior where that contradicts it, else what is stated.
  PriorMisfit worse_of_response(const Eigen::VectorXd& theta, const PriorMisfit& stated) const;
  /// False where the law, the contact, damping or sensors leave what a string can be.
  bool admits(const Eigen::VectorXd& theta) const;
  ModelPoint model(const Eigen::VectorXd& theta) const;
  /// None of what is held.
  LikelihoodColumns columns(const Eigen::VectorXd& theta, std::size_t record = 0) const;
  /// Coordinate of a prior (StatedPriors), linear about θ in z = (θ, ln f_0, B), the last two those
  /// of the law where every frequency is free; none where nothing of θ moves it.
  std::optional<LinearForm> coordinate(const ParameterName& name,
                                       const Eigen::VectorXd& theta) const;
  /// Priors stated and those of every ζ_n, linear about θ.
  QuadraticPrior prior(const Eigen::VectorXd& theta) const;
  /// The same with frequencies about the law.
  QuadraticPrior prior(const Eigen::VectorXd& theta, const LawScatter& law) const;
  /// What is stated, with the law's scatter, linear about θ.
  PriorEquations stated(const Eigen::VectorXd& theta, const LawScatter& law) const;
  /// Adds the priors of every ζ_n about `mean`, where each is free, unless something else is stated
  /// of it, and those of the response.
  void state_widths(const std::vector<double>& mean, PriorEquations& equations) const;
  /// What is stated against θ; with the law's scatter where every frequency is free.
  PriorMisfit prior_misfit(const Eigen::VectorXd& theta) const;
  PriorMisfit prior_misfit(const Eigen::VectorXd& theta, const LawScatter& law) const;
  /// The same unknowns with other priors.
  StringUnknowns under(StatedPriors priors) const;
  Eigen::VectorXd log_frequencies() const;  ///< ln f_n of the reference
  /// Holds what is held, the law's f_0 and B among it.
  void hold(PriorEquations& equations) const;

 private:
  LinearForm form(double offset) const;
  PriorEquations stated(const Eigen::VectorXd& theta) const;
  PriorMisfit misfit_at(const Eigen::VectorXd& theta, const PriorEquations& equations) const;
  StatedPriors::Coordinate coordinates(const Eigen::VectorXd& theta) const;
  double damping_change(std::size_t mode, const Eigen::VectorXd& theta) const;
  /// Names of θ in their order.
  void list();
  Eigen::Index knot(std::size_t k) const { return named() + 2 * static_cast<Eigen::Index>(k); }

  ModelPoint reference_;
  UnknownsOptions options_;
  StatedPriors priors_;
  double fundamental_ = 0.0;
  double inharmonicity_ = 0.0;
  bool law_ = false;
  FreeParameters free_;
  std::size_t knots_ = 0;
  Eigen::Index damping_count_ = 0;
};

/// Covariance of ln ζ_n of these modes about the stated ones, where each is free and nothing else
/// is stated of it.
Eigen::MatrixXd ratio_covariance(const UnknownsOptions& options,
                                 std::span<const std::size_t> modes);

}  // namespace modcal
