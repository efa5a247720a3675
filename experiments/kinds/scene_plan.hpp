// What the simulations of a run will do, said before they are done.
#pragma once

#include <optional>
#include <string>

#include "experiments/experiment.hpp"
#include "experiments/study/observation.hpp"

namespace modcal {

/// How many simulations of how many samples, others of the run behind them.
std::string plan_line(const PlannedSimulations& planned);

/// The truth that a run simulates for inversions; nothing for a record.
std::optional<PlannedSimulations> planned_truths(const ObservationOptions& observation,
                                                 OutputRequest outputs, std::size_t count = 1);

/// Adds a simulation of another scene, once.
void add_planned(const ObservationOptions& observation, PlannedSimulations& planned);

}  // namespace modcal
