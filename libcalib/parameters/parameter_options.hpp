// What a calibration frees, fixes and knows beforehand: section "parameters".
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libcalib/parameters/parameters.hpp"
#include "libcalib/parameters/stated_priors.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// One number that is fixed at its value or free, started there.
struct UnknownOption {
  bool free = false;
  double value = 0.0;
};

/// What is unknown of the damping and of the sensor at x = L beside frequencies and contact, and
/// what is known of all of them beforehand.
struct UnknownsOptions {
  /// "fixed": ζ_n as stated; "factor": times one factor; "power": times a factor and a power of n;
  /// "each": every ζ_n, under a prior about the stated one.
  std::string damping = "factor";
  double damping_width = 0.3;        ///< sd of the prior of each ln ζ_n, with "each" [1]
  UnknownOption gain{.value = 1.0};  ///< of the sensor at x = L over that at x = 0 [1]
  UnknownOption delay;               ///< [s]
  UnknownOption corner;              ///< [Hz]
  /// What each record has for itself, of x_c, gain, delay, corner and the factor "damping".
  std::vector<std::string> per_record = {"x_c"};
  std::vector<FixedParameter> fixed;
  std::vector<ParameterPrior> priors;
  std::vector<PriorCorrelation> correlations;
  void visit(OptionVisitor& visitor);
  SensorPair sensors() const;                     ///< start
  std::vector<std::string> free_sensors() const;  ///< some of gain, delay, corner
  /// Whether it is each record's own.
  bool own(UnknownKind kind) const;
  /// Throws InvalidInput where per_record names what is fixed, unknown or named twice.
  void require_sharing() const;
  /// Throws InvalidInput for a prior or a fixed value of a contact that no stroke has.
  void require_contacts(std::size_t strokes) const;
};

/// Section "parameters" of a calibration.
struct ParameterOptions {
  std::string frequencies = "none";  ///< none, all, listed
  std::vector<std::int64_t> modes;   ///< mode numbers, with frequencies: listed
  bool law = false;                  ///< f0 and B
  bool contact = false;              ///< x_c
  UnknownsOptions unknowns{.damping = "fixed"};
  /// Relative width τ of the prior of f_n about the law; NaN: estimated from the modes the data see
  /// well [1].
  double law_width = std::numeric_limits<double>::quiet_NaN();
  ParameterRanges ranges;
  void visit(OptionVisitor& visitor);
  bool every_frequency() const;
  /// Names for a model of N modes. Throws InvalidInput where modes are listed but not asked for, or
  /// nothing is free.
  std::vector<std::string> names(std::size_t modes_of_model) const;
};

}  // namespace modcal
