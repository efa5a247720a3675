// Whether both reactions of a record are all of what was recorded.
#pragma once

#include "experiments/study/observation.hpp"

namespace modcal {

/// Throws InvalidInput where an equal value stands before what was recorded: a string that was at
/// rest reaches both ends within a period, and not at once.
void require_whole_beginning(const ObservationOptions& options, const RecordedSignals& signals);

/// Throws InvalidInput where a low-pass has emptied a band: noise that it took out weighs no
/// answer.
void require_whole_band(const RecordOptions& record, const RecordedSignals& signals);

}  // namespace modcal
