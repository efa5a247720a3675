// The model-based estimate of an observation, scored where the truth is known.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/study/identification.hpp"
#include "libinverse/observer/model_based_estimator.hpp"

namespace modcal {

/// One window of comparison, anti-aliased figures included where the score asks for them.
struct ModelScore {
  std::string window;  ///< "0.78 s", or "0.1 s to 0.95 s" of the long window
  WindowScore model;   ///< the model-based estimate
  WindowScore linear;  ///< the linear estimate the observer started from
};

struct ModelIdentification {
  ModelBasedResult result;
  std::vector<ModelScore> scores;  ///< the windows asked for, then the long one
};

/// Estimates and, with `score` and a reference, scores. Throws InvalidInput for an observation with
/// one reaction.
ModelIdentification identify_by_model(const Observation& observation, const AssumedModel& model,
                                      const ModelBasedOptions& options, const ScoreOptions* score,
                                      const std::function<bool()>& interrupted);

}  // namespace modcal
