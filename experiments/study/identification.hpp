// Identified force and motion at the contact, scored where a reference is known.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "experiments/study/observation.hpp"
#include "experiments/study/scoring.hpp"
#include "libinverse/invert.hpp"

namespace modcal {

/// One estimate of a record with its scores; empty without a reference.
struct SideIdentification : ForceScores {
  Estimate estimate;
};

/// Estimators prepared for one model and record length, shared by the cells of a sweep that assume
/// the same model. Keeps the last few: a sweep over model errors has as many models as cells.
class InversionCache {
 public:
  using Prepared = std::shared_ptr<const PreparedEstimator>;
  Prepared get(const AssumedModel& model, const Observation& observation,
               const InversionOptions& options, const InversionRecipe& recipe);

 private:
  std::mutex mutex_;
  // The model's numbers and the estimator's options, bit for bit.
  std::deque<std::pair<std::string, Prepared>> prepared_;
};

/// The estimator of `recipe` with its transfer functions.
InversionCache::Prepared prepare_estimator(const AssumedModel& model,
                                           const Observation& observation,
                                           const InversionRecipe& recipe);

/// Scores of an identified force of the observation; none where `score` is null or the observation
/// has no reference.
ForceScores scores_of(const Observation& observation, std::span<const double> force,
                      const ScoreOptions* score, std::span<const double> unaliased = {});

/// Inverts the reactions of the observation; `score` null: no scores.
std::vector<SideIdentification> identify(const Observation& observation,
                                         const PreparedEstimator& estimator,
                                         const InversionRecipe& recipe,
                                         const InversionOutputs& outputs,
                                         const ScoreOptions* score);

}  // namespace modcal
