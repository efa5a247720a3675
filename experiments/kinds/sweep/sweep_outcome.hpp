// Outcome of one task of a sweep, and its text in the store.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "experiments/study/identification.hpp"
#include "experiments/study/scoring.hpp"

namespace modcal {

/// Outcome of one task (cell) on one side.
struct TaskScores {
  std::string side;  ///< "1", "2", "joint", …
  double parameter = 0.0;
  ChoiceStatus status = ChoiceStatus::kNotComputed;
  std::vector<WindowScore> scores;
  WindowScore whole;
  /// Mean square of what the estimate leaves of the data over that of their noise; NaN: not known.
  double misfit = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> warnings;
};

struct TaskOutcome {
  std::vector<TaskScores> sides;
  std::string failure;  ///< why the task failed; empty: it did not
};

/// JSON on one line; read_outcome gives back every bit.
std::string outcome_text(const TaskOutcome& outcome);
/// Throws InvalidInput for a text that outcome_text did not write.
TaskOutcome read_outcome(const std::string& text);

}  // namespace modcal
