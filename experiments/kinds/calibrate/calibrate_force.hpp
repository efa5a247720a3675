// The force and motion at the contact that a calibration's model tells, sensors made alike.
#pragma once

#include "experiments/kinds/calibrate/calibrate.hpp"

namespace modcal {

struct CalibratedForce {
  Sensor sensors;           ///< what was found of that at x = L, and taken out
  Observation observation;  ///< without it
  std::vector<SideIdentification> sides;
  /// What free decays leave of the record over its noise (JointInversion::ringing_misfit); NaN of a
  /// simulation, of a fit that is not right and where more than the record holds the string.
  double ringing_misfit = std::numeric_limits<double>::quiet_NaN();
};

/// Inverts the record with the refined model. Of a fit with an estimate the deviations hold what
/// the string may be, too: to the variance given the model is added E |F(θ) − F(θ̂)|² of models
/// drawn from the posterior, each with its own contact and sensors (law of total variance).
/// Throws Interrupted where `stop` was requested before all were inverted.
CalibratedForce identify_calibrated(const CalibrateOptions& options, const Observation& measured,
                                    const CalibrationOutcome& outcome,
                                    const InversionOutputs& outputs, const StopToken& stop = {});

/// The same with this estimator; the one that is selected keeps its own options.
InversionOptions with_estimator(const char* name, InversionOptions options);

/// The observation with S = gain exp(−s delay) s/(s + corner) taken out of the reaction at x = L,
/// which had a sensor that a calibration found to differ: R₂ = R₂' / S. The delay is shifted back
/// (see advanced()). A high-pass is undone as y + corner ∫ y dt; without the level that the sensor
/// lost, a line is left over the record, and it is taken out. Equal sensors: unchanged.
Observation with_sensors_alike(Observation observation, const Sensor& sensors);

/// Throws InvalidInput where calibration and estimator take the ends to feel different reactions,
/// or where the estimator is told of sensors that differ and the calibration finds or is told how
/// they do, too: with_sensors_alike() has then taken out what the estimator takes out.
void require_agreement(const CalibrationOptions& calibration, const Estimator& estimator,
                       bool recorded);

/// What a record's calibration frees unasked, with the sizes of the priors; empty: nothing.
std::string default_text(const CalibrationOptions& calibration, const Observation& observation);

/// What was taken out, for a report; empty for equal sensors or where x = L was not recorded.
std::string correction_text(const Observation& observation, const Sensor& sensors);

}  // namespace modcal
