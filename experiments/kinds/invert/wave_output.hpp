// Wave-based reconstructions of an observation, as a baseline and as a check that shares no code
// with the modal inversion.
#pragma once

#include "experiments/study/model_error.hpp"
#include "experiments/study/observation.hpp"
#include "experiments/study/scoring.hpp"
#include "experiments/study/study.hpp"

namespace modcal {

/// Reconstructs the force from the waves of both reactions, in the time domain (ideal string) and
/// with loss and dispersion, from either outgoing wave; scores them where a reference is known.
/// Throws InvalidInput for an observation with one reaction.
void add_wave_based(const Observation& observation, const AssumedModel& model,
                    const ScoreOptions& score, const std::string& command, StudyResult& result);

}  // namespace modcal
