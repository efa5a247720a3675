// The searches of a calibration, one after the other within one budget.
#pragma once

#include <optional>
#include <string>

#include "experiments/kinds/calibrate/calibrate.hpp"

namespace modcal {

/// The highest mode that the data tell, 0 where they tell none; nothing where frequencies were not
/// free.
std::optional<std::size_t> highest_identified(const CalibrationOutcome& outcome);

/// Twice the highest mode identified, and fifteen in any case. Where the lines of a force fade into
/// noise, modes far above the last that is identified have many places in it: B then ends in one of
/// many minima, whose deviation knows nothing of the others.
std::size_t modes_told(std::size_t highest);

/// With as many modes as the record tells: where it took more at first, once more, by what is left
/// of the budget.
CalibrationOutcome calibrate_as_told(CalibrateOptions options, ObservedRecords& observed,
                                     const StudyContext& context);

/// Why an x_c that the ends of a record do not tell is no answer; empty: it is one. Every few
/// millimeters may have a minimum, whose deviation knows nothing of the others: what starts beside
/// the place stated is to come to the same one. Its searches count in the outcome.
std::string another_contact(CalibrateOptions options, const ObservedRecords& observed,
                            const StudyContext& context, CalibrationOutcome& outcome);

}  // namespace modcal
