// What a calibration frees, fixes and knows beforehand: section "parameters".
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libcalib/parameters/parameter_table.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// One number that is fixed at its value or free, started there.
struct UnknownOption {
  bool free = false;
  double value = 0.0;
};

/// f0, B, x_c, a single f_n or zeta_n, fixed at a value.
struct FixedParameter {
  std::string parameter;
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN: the initial value
  void visit(OptionVisitor& visitor);
};

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

/// The smooth response of the sensor at x = L against that at x = 0: its knots (SmoothResponse) are
/// unknowns under a prior about 0.
struct ResponseOptions {
  bool free = false;
  double width = 5e-3;  ///< sd of the prior of the real and of the imaginary part of a knot [1]
  /// Between knots [Hz]; NaN: f_1, at most 300 Hz, at least a hundredth of f_N.
  double spacing = std::numeric_limits<double>::quiet_NaN();
  std::size_t knots = 0;  ///< up to above f_N; see laid_out()
  void visit(OptionVisitor& visitor);
  /// With spacing and knots for these modes. Throws InvalidInput where these would be over 400.
  ResponseOptions laid_out(const ModalBasis& basis) const;
};

/// What is unknown of the damping and of the sensor at x = L beside frequencies and contact, and
/// what is known of all of them beforehand.
struct UnknownsOptions {
  /// "auto": each of a recorded string, fixed of a simulated one; "fixed": ζ_n as stated; "factor":
  /// times one factor; "power": times a factor and a power of n; "each": every ζ_n, under a prior
  /// about the stated one.
  std::string damping = "factor";
  double damping_width = 0.3;  ///< sd of the prior of each ln ζ_n, with "each" [1]
  /// Of that the scatter of each by itself; the rest is that of a smooth curve in ln n, alike
  /// within an e-fold of n. NaN: all of it, each by itself [1].
  double damping_scatter = std::numeric_limits<double>::quiet_NaN();
  /// Gain [1], delay [s] and corner [Hz] of the sensor at x = L.
  std::array<UnknownOption, Sensor::kCount> sensor = {{{.value = 1.0}}};
  ResponseOptions response;
  bool exact_sensors = false;  ///< they are as stated, in a record too
  /// Frequency of the mains, whose lines have unknown amplitudes [Hz]; 0: there are none; NaN:
  /// looked for in a record.
  double mains = 0.0;
  /// What the fit of every frequency leaves is tested for causes that the model has not.
  bool tests = false;
  /// What each record has for itself, of x_c, gain, delay, corner and the factor "damping".
  std::vector<std::string> per_record = {"x_c"};
  std::vector<FixedParameter> fixed;
  std::vector<ParameterPrior> priors;
  std::vector<PriorCorrelation> correlations;
  void visit(OptionVisitor& visitor);
  Sensor sensors() const;                         ///< start
  std::vector<std::string> free_sensors() const;  ///< the names of some of gain, delay, corner
  /// Of records, of which nothing is stated that says otherwise: gain, delay and corner are free
  /// under priors of 2 %, one sample and 1 Hz, their smooth response under its own, every ln ζ_n
  /// under one of 1. What two sensors differ by biases f_n by many of their deviations before any
  /// test of the misfit sees it.
  UnknownsOptions of_records(double sample_rate, const ModalBasis& basis) const;
  /// The same of simulated strings.
  UnknownsOptions of_simulations(const ModalBasis& basis) const;
  /// Throws InvalidInput for what a schedule alone finds, a response or lines of the mains, where
  /// this optimizer has none.
  void require_found_by(std::string_view optimizer, bool has_schedule) const;
  /// Whether it is each record's own.
  bool own(const ParameterName& name) const;
  /// Throws InvalidInput for a prior or a fixed value of a contact that no stroke has.
  void require_contacts(std::size_t strokes) const;
};

/// Section "parameters" of a calibration.
struct ParameterOptions {
  std::string frequencies = "none";  ///< none, all, listed
  std::vector<std::int64_t> modes;   ///< mode numbers, with frequencies: listed
  bool law = false;                  ///< f0 and B
  bool contact = false;              ///< x_c
  UnknownsOptions unknowns{.damping = "auto", .mains = std::numeric_limits<double>::quiet_NaN()};
  /// Relative width τ of the prior of f_n about the law; NaN: estimated from the modes the data see
  /// well [1].
  double law_width = std::numeric_limits<double>::quiet_NaN();
  ParameterRanges ranges;
  void visit(OptionVisitor& visitor);
  bool every_frequency() const;
  bool no_frequency() const;
  /// Names for a model of N modes. Throws InvalidInput where modes are listed but not asked for, or
  /// nothing is free.
  std::vector<std::string> names(std::size_t modes_of_model) const;
};

/// Throws InvalidInput for a name that is unknown, repeated, both fixed and with a prior, or of
/// something that is not free; a fixed value, mean or deviation that no string has; fewer than two
/// frequencies left to find a free law by; correlations that no Gaussian has; per_record that names
/// what is fixed, unknown or named twice. modes, length [m]: of the string.
void require_priors(const UnknownsOptions& options, std::size_t modes, std::size_t records = 1,
                    double length = std::numeric_limits<double>::infinity());

/// Correlations of the priors in their order. Throws InvalidInput for one of a parameter that has
/// no prior, of one with itself, twice the same and outside (−1, 1).
Eigen::MatrixXd prior_correlation(const UnknownsOptions& options);

/// The initial model with the values stated: frequencies, damping ratios, the first contact.
ModelPoint with_fixed(ModelPoint initial, const UnknownsOptions& options);

}  // namespace modcal
