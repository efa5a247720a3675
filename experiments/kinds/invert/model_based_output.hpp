// What an inversion shows of its model-based estimate.
#pragma once

#include "experiments/study/model_based.hpp"
#include "experiments/study/study.hpp"

namespace modcal {

/// One row a window: sampled, between samples, and the linear estimate beside them.
report::Table model_score_table(const ModelIdentification& identification,
                                const std::string& command);
/// Fitted parameters, noise, misfit and how far the static part is recovered.
report::Table model_parameter_table(const ModelIdentification& identification,
                                    const std::string& command);
/// The fitted friction laws, the best supported first.
report::Table friction_law_table(const ModelIdentification& identification,
                                 const std::string& command);
/// Force over slip speed: loops over two periods, cells with their 5–95 % spread of the model-based
/// and the linear estimate, the fitted law.
report::Figure friction_figure(const Observation& observation,
                               const ModelIdentification& identification, double start,
                               double duration, const std::string& command);
/// Identified force over the true and the linear one, two periods from `start` [s].
report::Figure model_force_figure(const Observation& observation,
                                  const ModelIdentification& identification, double start,
                                  double duration, const std::string& command);
/// Adds f_c_model, v_model and y_model to identified signals.
void add_model_signals(const Observation& observation, const ModelIdentification& identification,
                       SignalFile& file);
/// Tables, figure, warnings and lines of the summary.
void add_model_based(const Observation& observation, const ModelIdentification& identification,
                     const ScoreOptions& score, const std::string& command, StudyResult& result);

}  // namespace modcal
