// One attempt of a continuation: everything between a start of f_0 and a verdict by χ².
#pragma once

#include <optional>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"

namespace modcal {

/// What all attempts at one record have in common; all must outlive them.
struct AttemptInput {
  const ModelPoint& initial;
  NoisyRecords& records;  ///< whose noise take_noise() finds
  const ContinuationOptions& options;
  const StatedPriors& priors;
  double highest = 0.0;  ///< ω of the highest bin [rad/s]
  /// The noise is what a wrong model leaves: no mode is said to leave a law by it.
  bool misfit_for_noise = false;
  /// The record begins in mid-stroke: damped, it would be told by what rings at its start, so that
  /// its first part stands for it, undamped.
  bool moving = false;
  /// No other record has a part in the answer: a bridge that moves may be taken out of this one.
  bool alone = true;
  Evaluator* within = nullptr;
  /// What the first attempt found of the law, by itself.
  std::optional<LawEstimate>& first_law;

  /// Levels as they were read above the modes, or stated [N].
  std::array<double, 2> read = records.deviation;
  double read_error = records.power_error;  ///< relative standard deviation of their power
  /// Levels are read above the modes, where noise may be another and the string may still sound:
  /// what a fit leaves says more (fit_noise()). Levels that are stated stay. True: the noise of the
  /// records has changed, by more than `share` of its power somewhere.
  bool take_noise(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                  double share) const;
};

/// From ln f_0 of the start `shift` higher [1]; evaluations: those spent before, which count too.
/// Where another start has led to the first law again, all else would follow again, too: the result
/// holds the law alone (ContinuationResult::repeats).
ContinuationResult attempt_continuation(const AttemptInput& input, double shift,
                                        std::size_t evaluations = 0);

}  // namespace modcal
