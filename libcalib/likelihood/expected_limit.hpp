// What a calibration can reach: Fisher matrix with the force unknown, before any experiment.
#pragma once

#include "libcalib/likelihood/continuation.hpp"
#include "libcalib/likelihood/whitened_record.hpp"

namespace modcal {

/// Cramér–Rao bounds of the joint likelihood at the truth.
struct ExpectedLimit {
  std::array<double, 4> law{};  ///< sd of f_0 [Hz], B, x_c [m], damping factor
  /// The same where the force is not known, only how much each bin can tell: what noise in the
  /// slopes costs beyond the bound (Neyman and Scott, 1948).
  std::array<double, 4> law_attainable{};
  std::array<std::array<double, 4>, 4> law_correlation{};
  double contact = 0.0;            ///< sd of x_c with every frequency free [m]
  double damping = 0.0;            ///< sd of the damping factor with every frequency free
  std::vector<ModeVerdict> modes;  ///< with every frequency free under the law prior
  /// Singular values of the whitened Jacobian in (ln f_1 … ln f_N), largest first: the inverse
  /// standard deviation of each combination, all else known.
  std::vector<double> singular_values;
  std::size_t blind_modes = 0;  ///< not identified
};

/// records: the reactions without noise, `deviation` the noise expected. law_width: τ of the prior
/// about the law [1]; modes that prior dominates are tied to the law, as the calibration does.
/// Information 2 Re J⊥ᴴJ⊥ of clean data, end state projected out; attainable is the root of the
/// diagonal of ½A⁻¹(Re J⊥ᴴW²J⊥ + N̄)A⁻¹, A = Re J⊥ᴴWJ⊥, W the best weights, N̄ what
/// noise adds to Re J⊥ᴴW²J⊥.
ExpectedLimit expected_limit(const ModelPoint& truth, const NoisyRecords& records,
                             double highest_frequency, double law_width);

/// Contact points near x_c, best first: those at which every mode keeps a shape of at least
/// `least_shape`, or, where there is none, the largest least shape; nearest first among equals.
std::vector<double> contacts_without_blind_modes(const ModelPoint& point, double reach,
                                                 double least_shape, std::size_t count);

}  // namespace modcal
