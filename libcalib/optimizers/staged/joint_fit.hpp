// All records of one string at once, from fits of every stroke by itself.
#pragma once

#include <span>

#include "libcalib/optimizers/staged/records_fit.hpp"

namespace modcal {

/// Fills all of `fit` save `single`, which it starts from (calibrate_records); poll: called before
/// every evaluation of all records.
void fit_jointly(const ModelPoint& initial, const ContinuationOptions& options,
                 const StatedPriors& priors, std::span<const CalibrationData> strokes,
                 std::span<const PluckRecord> plucks, const FitPoll& poll, RecordsFit& fit);

}  // namespace modcal
