// What is known of the unknowns before the data: one Gaussian, and what is known exactly.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libcalib/parameters/parameter_options.hpp"
#include "libcalib/parameters/prior_equations.hpp"

namespace modcal {

/// Misfit of k stated coordinates with residual d and covariance C. Where the statements are true,
/// d at the fit scatters by no more than C, so that chi2 is at most a χ² of k degrees of freedom.
struct PriorMisfit {
  double chi2 = 0.0;        ///< dᵀC⁻¹d
  std::size_t count = 0;    ///< k
  std::string farthest;     ///< parameter of largest |d_i|/√C_ii
  double deviations = 0.0;  ///< that quotient
  /// chi2 is above the quantile 0.9973 of χ²_k, three standard deviations of one coordinate.
  bool contradicted() const;
};

/// The priors as one Gaussian of coordinates (ParameterType): the logarithm of what is positive,
/// with the relative deviation, else the value itself, a corner in rad/s. The factor of the damping
/// is stated through ζ_1; the exponent through ln ζ_2/ζ_1. What is fixed has no deviation.
class StatedPriors {
 public:
  struct Entry {
    ParameterName name;
    double mean = 0.0;       ///< of the coordinate
    double deviation = 0.0;  ///< of the coordinate
    std::string parameter;   ///< as it was stated
  };
  /// Coordinate of a name; none where nothing that is free moves it.
  using Coordinate = std::function<std::optional<LinearForm>(const ParameterName&)>;

  StatedPriors() = default;
  /// initial: model that "initial" means, damping ratios that a factor is of.
  StatedPriors(const UnknownsOptions& options, const ModelPoint& initial, std::size_t records = 1);

  const std::vector<Entry>& entries() const { return entries_; }
  /// The value at which a parameter is fixed, in its unit; none: it is not fixed.
  std::optional<double> fixed(const ParameterName& name) const;
  std::optional<double> fixed_contact(std::size_t record) const {
    return fixed({.kind = ParameterKind::kContact, .record = record});
  }
  bool fixes_frequency(std::size_t mode) const {
    return fixed({.kind = ParameterKind::kFrequency, .index = mode}).has_value();
  }
  bool fixes_ratio(std::size_t mode) const {
    return fixed({.kind = ParameterKind::kDampingRatio, .index = mode}).has_value();
  }
  /// Adds what is stated of the coordinates that there are; the others are unknown.
  void state(const Coordinate& coordinate, PriorEquations& equations) const;
  /// What is stated against z = (θ, ln f_0, B), see PriorEquations::completed().
  PriorMisfit misfit(const Coordinate& coordinate, const Eigen::VectorXd& z) const;
  /// What is stated of one record and of all of them, as that of a first one.
  StatedPriors of_record(std::size_t record) const;
  /// All but what is stated of single frequencies.
  StatedPriors without_frequencies() const;
  /// The same with the frequencies of these modes fixed where the reference has them.
  StatedPriors fixing(const std::vector<std::size_t>& modes) const;
  bool has(const ParameterName& name) const;

 private:
  struct Found {
    std::vector<LinearForm> forms;
    std::vector<Eigen::Index> which;
    Eigen::VectorXd means;
    Eigen::MatrixXd covariance;
  };
  struct Fixed {
    ParameterName name;
    double value = 0.0;
  };
  Found found(const Coordinate& coordinate) const;
  template <typename Taken>
  StatedPriors kept(const Taken& taken) const;
  bool is_own(const ParameterName& name) const;

  std::vector<ParameterName> own_;  // each record's own
  std::vector<Fixed> fixed_;
  std::vector<Entry> entries_;
  Eigen::MatrixXd correlation_;
};

}  // namespace modcal
