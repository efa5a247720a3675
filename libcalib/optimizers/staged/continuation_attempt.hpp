// One attempt of a continuation: everything between a start of f_0 and a verdict by χ².
#pragma once

#include "libcalib/likelihood/whitened_record.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"

namespace modcal {

/// What all attempts at one record have in common; all must outlive them.
struct AttemptInput {
  const ModelPoint& initial;
  NoisyRecords& records;  ///< whose noise levels lower_noise() lowers
  const ContinuationOptions& options;
  const StatedPriors& priors;
  double highest = 0.0;      ///< ω of the highest bin [rad/s]
  double noise_error = 0.0;  ///< relative standard deviation of the noise power
  /// The noise is what a wrong model leaves: no mode is said to leave a law by it.
  bool misfit_for_noise = false;
  Evaluator* within = nullptr;

  /// Levels as they were read above the modes, or stated [N].
  std::array<double, 2> read = records.deviation;
  /// What was read holds what the string still sounds above its modes, too. Where a fit leaves so
  /// much less, chi2, that error bars are a tenth too wide, what it leaves is the noise. Levels
  /// that are stated stay. True: they are lowered.
  bool lower_noise(double chi2) const;
  /// Lowered by a part of the record, they are what the whole record leaves, chi2: up to a tenth
  /// more or less, which a misfit of the whole would hide in, and no more than was read. True: they
  /// have changed.
  bool correct_noise(double chi2) const;
};

/// From ln f_0 of the start `shift` higher [1]; evaluations: those spent before, which count too.
ContinuationResult attempt_continuation(const AttemptInput& input, double shift,
                                        std::size_t evaluations = 0);

}  // namespace modcal
