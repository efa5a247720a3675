// What a run will cost, found out by doing a small part of its work.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "experiments/experiment.hpp"
#include "libsim/dynamics/plan.hpp"

namespace modcal {

class TaskExperiment;

struct Price {
  double core_seconds = 0.0;         ///< processor time of everything that is priced [s]
  std::optional<double> disk_bytes;  ///< of the journal of a list's outcomes
  std::string basis;                 ///< what was measured
};

/// Price of a list of tasks: does tasks that stand evenly in it, for about `budget` [s] of
/// processor time. `simulations`: distinct simulations that the tasks share; what one costs is told
/// from the tasks that needed a new one. Throws InvalidInput where a task cannot be done at all.
Price price_of_tasks(const TaskExperiment& list, std::size_t simulations,
                     const StudyContext& context, double budget = 1.0);

/// Price of the simulations alone.
Price price_of_simulations(const SimulationPlan& plan, const PlannedSimulations& planned);

/// "27.3 core-seconds (0.00758 core-hours), 13.6 s on 2 threads, 0.94 MB on disk".
std::string text_of(const Price& price, std::size_t threads);

}  // namespace modcal
