// What a calibration says in a few lines.
#pragma once

#include "experiments/kinds/calibrate_study.hpp"

namespace modcal {

/// Adds the search, its parameters with standard deviations, and the verdicts of the fit.
void add_calibration_summary(const CalibrationOutcome& outcome, StudyResult& result);

/// Warns of bounds that were reached, of blind modes and of a search that failed, which fails the
/// task.
void add_calibration_warnings(const CalibrationOutcome& outcome, StudyResult& result);

}  // namespace modcal
