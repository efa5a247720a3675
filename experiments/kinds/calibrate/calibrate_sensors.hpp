// Reactions as two equal sensors would have read them.
#pragma once

#include <string>

#include "experiments/study/observation.hpp"
#include "libcalib/calibration.hpp"
#include "libinverse/estimator.hpp"

namespace modcal {

/// The observation with S = gain exp(−s delay) s/(s + corner) taken out of the reaction at x = L,
/// which had a sensor that a calibration found to differ: R₂ = R₂' / S. The delay is shifted back
/// (see advanced()). A high-pass is undone as y + corner ∫ y dt; without the level that the sensor
/// lost, a line is left over the record, and it is taken out. Equal sensors: unchanged.
Observation with_sensors_alike(Observation observation, const SensorPair& sensors);

/// Throws InvalidInput where the estimator is told of sensors that differ and the calibration finds
/// or is told how they do, too: with_sensors_alike() has then taken out what the estimator takes
/// out.
void require_sensors_once(const CalibrationOptions& calibration, const Estimator& estimator);

/// What was taken out, for a report; empty for equal sensors or where x = L was not recorded.
std::string correction_text(const Observation& observation, const SensorPair& sensors);

}  // namespace modcal
