// What a calibration can reach: Fisher matrix with the force unknown, before any experiment.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "libcalib/identifiability/continuation_result.hpp"
#include "libcalib/likelihood/records/whitened_record.hpp"

namespace modcal {

/// What is recorded of a string and what a calibration frees of it.
struct LimitCase {
  ModelPoint truth;                   ///< x_c of the first stroke
  std::vector<NoisyRecords> strokes;  ///< without noise, `deviation` the noise expected
  std::vector<double> contacts;       ///< x_c of each stroke [m]
  std::vector<NoisyRecords> plucks;   ///< likewise; they begin when the string has been let go
  /// As in ContinuationOptions [Hz].
  double highest_frequency = std::numeric_limits<double>::quiet_NaN();
  double law_width = 2e-3;   ///< τ of the prior about the law [1]
  UnknownsOptions unknowns;  ///< damping, sensors, priors
};

/// Standard deviations of one parameter, in the unit of its name (unit_of_parameter); NaN where it
/// is not free. "damping" is the factor of all ζ_n; where each is free, their geometric mean.
struct ParameterLimit {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::string parameter;
  double law = kNan;                 ///< all frequencies on the law
  double attainable = kNan;          ///< the same, see ExpectedLimit::law_attainable
  double free = kNan;                ///< every frequency free
  std::vector<double> correlations;  ///< of the law, with the parameters before it
};

/// Cramér–Rao bounds of the joint likelihood at the truth.
struct ExpectedLimit {
  /// f0, B, x_c and, where they are free, damping, x_c of further strokes, damping_power, gain,
  /// delay, corner, zeta_n.
  std::vector<ParameterLimit> parameters;
  /// sd of f_0 [Hz], B, x_c [m], damping factor (0 where it is fixed).
  std::array<double, 4> law{};
  /// The same where the force is not known, only how much each bin can tell: what noise in the
  /// slopes costs beyond the bound (Neyman and Scott, 1948).
  std::array<double, 4> law_attainable{};
  std::array<std::array<double, 4>, 4> law_correlation{};
  double contact = 0.0;            ///< sd of x_c with every frequency free [m]
  double damping = 0.0;            ///< the same of the damping factor; 0 where it is fixed
  std::vector<ModeVerdict> modes;  ///< with every frequency free under the law prior
  /// Singular values of the whitened Jacobian in (ln f_1 … ln f_N), largest first: the inverse
  /// standard deviation of each combination, all else known.
  std::vector<double> singular_values;
  std::size_t blind_modes = 0;  ///< not identified

  const ParameterLimit* find(const std::string& parameter) const;  ///< null: it is not free
};

/// Information 2 Re J⊥ᴴJ⊥ of clean data, end state or decays projected out; records are
/// independent, so theirs add, and priors add their precision. Every stroke has an x_c of its own,
/// all else is shared. Modes that the law's prior dominates are tied to the law, as the calibration
/// does. attainable is the root of the diagonal of H⁻¹(2(Re J⊥ᴴW²J⊥ + N̄) + Q)H⁻¹, H = 2 Re J⊥ᴴWJ⊥
/// + Q, W the best weights of the strokes' bins, N̄ what noise adds to Re J⊥ᴴW²J⊥, Q the priors.
/// Throws InvalidInput for no stroke, contacts of another number, priors that fit to nothing.
ExpectedLimit expected_limit(const LimitCase& question);

/// One stroke, a factor of the damping ratios free, no priors but the law's.
ExpectedLimit expected_limit(const ModelPoint& truth, const NoisyRecords& records,
                             double highest_frequency, double law_width);

/// Contact points near x_c, best first: those at which every mode keeps a shape of at least
/// `least_shape`, or, where there is none, the largest least shape; nearest first among equals.
std::vector<double> contacts_without_blind_modes(const ModelPoint& point, double reach,
                                                 double least_shape, std::size_t count);

}  // namespace modcal
