// Estimates beside the linear ones, by a friction law and by waves: scored where the truth is
// known, drawn, and added to the result of an inversion.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/study/figures.hpp"
#include "experiments/study/study.hpp"
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

/// Estimates and scores. Throws InvalidInput for an observation with one reaction.
ModelIdentification identify_by_model(const Observation& observation, const AssumedModel& model,
                                      const ModelBasedOptions& options, const ScoreOptions& score,
                                      const std::function<bool()>& interrupted);

/// Force over slip speed: loops over two periods, cells with their 5–95 % spread of the model-based
/// and the linear estimate, the fitted law.
report::Figure friction_figure(const Observation& observation, const ModelBasedResult& result,
                               double start, double duration);
/// Identified force over the true and the linear one, `duration` from `start` on [s].
report::Figure model_force_figure(const Observation& observation, const ModelBasedResult& result,
                                  double start, double duration);

/// Tables, figures, warnings and lines of the summary.
void add_model_based(const Observation& observation, const ModelIdentification& identification,
                     const ScoreOptions& score, StudyResult& result);
/// Adds f_c_model, v_model and y_model to identified signals.
void add_model_signals(const Observation& observation, const ModelBasedResult& model,
                       SignalFile& file);

/// Reconstructs the force from the waves of both reactions, in the time domain (ideal string) and
/// with loss and dispersion, from either outgoing wave, and scores it where a reference is known: a
/// baseline, and a check that shares no code with the modal inversion. Throws InvalidInput for an
/// observation with one reaction.
void add_wave_based(const Observation& observation, const AssumedModel& model,
                    const ScoreOptions& score, StudyResult& result);

}  // namespace modcal
