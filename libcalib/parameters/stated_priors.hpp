// What is known of the unknowns before the data: one Gaussian, and what is known exactly.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libcalib/parameters/held_parameters.hpp"
#include "libcalib/parameters/prior_equations.hpp"
#include "libcalib/parameters/prior_misfit.hpp"
#include "libcalib/parameters/parameters.hpp"
#include "libcalib/parameters/unknown_name.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// Mean and standard deviation of one parameter, in the unit of its name.
struct ParameterPrior {
  std::string parameter;
  double mean = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the initial value
  double deviation = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// Correlation of two parameters that have priors.
struct PriorCorrelation {
  std::vector<std::string> between;
  double value = 0.0;
  void visit(OptionVisitor& visitor);
};

struct UnknownsOptions;

/// Throws InvalidInput for a name that is unknown, repeated or of something that is not free, a
/// deviation or mean out of range, correlations that no Gaussian has; and what require_fixed()
/// throws. modes, length [m]: of the string.
void require_priors(const UnknownsOptions& options, std::size_t modes, std::size_t records = 1,
                    double length = std::numeric_limits<double>::infinity());

/// Correlations of the priors in their order. Throws InvalidInput for one of a parameter that has
/// no prior, of one with itself, twice the same and outside (−1, 1).
Eigen::MatrixXd prior_correlation(const UnknownsOptions& options);

/// The priors as one Gaussian of coordinates: the logarithm of what is positive (is_positive(),
/// with the relative deviation), else the value itself, a corner in rad/s. The factor of the
/// damping is stated through ζ_1; the exponent through ln ζ_2/ζ_1.
class StatedPriors {
 public:
  struct Entry {
    UnknownName name;
    double mean = 0.0;       ///< of the coordinate
    double deviation = 0.0;  ///< of the coordinate
    std::string parameter;   ///< as it was stated
  };
  /// Coordinate of a name; none where nothing that is free moves it.
  using Coordinate = std::function<std::optional<LinearForm>(const UnknownName&)>;

  StatedPriors() = default;
  /// initial: model that "initial" means, damping ratios that a factor is of.
  StatedPriors(const UnknownsOptions& options, const ModelPoint& initial, std::size_t records = 1);

  const std::vector<Entry>& entries() const { return entries_; }
  const HeldParameters& held() const { return held_; }
  /// Adds what is stated of the coordinates that there are; the others are unknown.
  void state(const Coordinate& coordinate, PriorEquations& equations) const;
  /// What is stated against z = (θ, ln f_0, B), see PriorEquations::completed().
  PriorMisfit misfit(const Coordinate& coordinate, const Eigen::VectorXd& z) const;
  /// What is stated of one record and of all of them, as that of a first one.
  StatedPriors of_record(std::size_t record) const;
  /// All but what is stated of single frequencies.
  StatedPriors without_frequencies() const;
  /// The same with the frequencies of these modes held where the reference has them.
  StatedPriors holding(const std::vector<std::size_t>& modes) const;
  bool has(const UnknownName& name) const;

 private:
  struct Found {
    std::vector<LinearForm> forms;
    std::vector<std::size_t> which;
    Eigen::VectorXd means;
  };
  Found found(const Coordinate& coordinate) const;
  StatedPriors kept(const std::vector<Eigen::Index>& entries) const;
  Eigen::MatrixXd covariance(const std::vector<std::size_t>& which) const;

  HeldParameters held_;
  std::vector<UnknownKind> own_;  // each record's own
  std::vector<Entry> entries_;
  Eigen::MatrixXd correlation_;
};

}  // namespace modcal
