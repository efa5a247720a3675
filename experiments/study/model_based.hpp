// The model-based estimate of an observation, scored where the truth is known.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/study/model_error.hpp"
#include "experiments/study/observation.hpp"
#include "experiments/study/scoring.hpp"
#include "libinverse/model_based/model_based_estimator.hpp"

namespace modcal {

/// One window of comparison: instants as sampled, and means between samples, which sampling does
/// not alias (only with a simulated truth).
struct ModelScore {
  std::string window;               ///< "0.78 s" or "whole"
  WindowScore sampled;              ///< of f_c at the samples
  WindowScore linear;               ///< the linear estimate the observer started from
  std::optional<WindowScore> mean;  ///< of the mean of f_c from a sample to the next
};

struct ModelIdentification {
  ModelBasedResult result;
  std::vector<ModelScore> scores;  ///< the windows asked for, then the whole record
};

/// Share of a record that counts as the whole: what is before is the start, after it the end, where
/// linear estimates suffer from truncation.
inline constexpr double kWholeFrom = 0.1, kWholeTo = 0.95;

/// Means of a simulated force between samples, from a truth sampled 16 times as fast.
std::vector<double> mean_force_between_samples(const ObservationOptions& options,
                                               TruthCache& cache);

/// Estimates and, with `score` and a reference, scores. `mean_truth`: empty, or as long as the
/// record. Throws InvalidInput for an observation with one reaction.
ModelIdentification identify_by_model(const Observation& observation, const AssumedModel& model,
                                      const ModelBasedOptions& options, const ScoreOptions* score,
                                      const std::vector<double>& mean_truth,
                                      const std::function<bool()>& interrupted);

}  // namespace modcal
