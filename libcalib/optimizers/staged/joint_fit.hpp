// All records of one string at once, from fits of every stroke by itself.
#pragma once

#include <span>

#include "libcalib/optimizers/staged/continuation.hpp"

namespace modcal {

/// Fills all of `fit` save `single`, which it starts from (calibrate_records); within: the search
/// that it is part of, or null.
void fit_jointly(const ModelPoint& initial, const ContinuationOptions& options,
                 const StatedPriors& priors, std::span<const CalibrationData> strokes,
                 std::span<const PluckRecord> plucks, Evaluator* within, ContinuationResult& fit);

}  // namespace modcal
