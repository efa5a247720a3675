#pragma once

#include "experiments/kinds/calibrate/calibrate_study.hpp"

namespace modcal {

/// Players for force and string velocity at the contact: the true ones where they are known, those
/// identified from each reaction and from both with the refined model. At most the first second,
/// low-passed and thinned to a rate near 22 kHz. The truth must have the velocity, if it is there.
report::Audio calibration_audio(const CalibrateOptions& options, const Observation& observation,
                                const AssumedModel& refined);

}  // namespace modcal
