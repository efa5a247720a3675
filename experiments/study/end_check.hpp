// Whether both reactions of a record are those of the string that is stated.
#pragma once

#include "experiments/study/observation.hpp"

namespace modcal {

/// Throws InvalidInput where both recorded reactions hold another relation than that of a string's
/// ends (fit_end_relations()): nothing but noise, copies, a turned sign, exchanged ends, no common
/// string within 3 % of f₀ and 2 % of L, or one that is broken off somewhere in the record.
void require_one_string(const ObservationOptions& options, const RecordedSignals& signals);

/// Throws InvalidInput where both reactions of a record tell an f₀ more than 0.2 % from the one
/// stated, which they tell to 0.05 %: an inversion takes it for granted, and modes are 2ζ wide.
void require_told_fundamental(const ObservationOptions& options, const Observation& observation);

}  // namespace modcal
