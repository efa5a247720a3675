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

/// What contradicts a result that is not right: χ², the priors stated, or both; else empty.
std::string contradiction(const ContinuationResult& found);

/// Which parameters the data identify. A frequency that the law or a prior holds moves with the
/// others by that alone.
std::vector<bool> told_by_data(const ContinuationResult& found);

/// The law's parameters with correlations and condition number, as `modcal limit` has them; where
/// every frequency is free the strongest correlations of what the data identify, too.
std::string covariance_text(const ContinuationResult& found);

}  // namespace modcal
