// What a calibration says in a few lines.
#pragma once

#include "experiments/kinds/calibrate/calibrate_study.hpp"

namespace modcal {

/// Adds the search, its parameters with standard deviations, and the verdicts of the fit.
void add_calibration_summary(const CalibrationOutcome& outcome, StudyResult& result);

/// Warns of bounds that were reached, of blind modes and of a search that failed, which fails the
/// task.
void add_calibration_warnings(const CalibrationOutcome& outcome, StudyResult& result);

/// What χ² says of a continuation's fit, in words.
std::string chi2_text(const ContinuationResult& found);

}  // namespace modcal
