// What a finished estimate of the observer is worth: misfit, static level, model error, refusals.
#pragma once

#include <span>
#include <string>

#include "libinverse/observer/model_based_estimator.hpp"
#include "libinverse/observer/tuning.hpp"

namespace modcal::observer {

/// Fills the misfit that a right model leaves and its deviation: what the gains let in of the noise
/// (`quiet_misfit`, one a gain), by the share of the blocks each gain serves; the scatter of the
/// median over blocks, √(π/2) that of the mean, and that of the noise levels it is relative to.
void judge_misfit(const ObservedRecord& record, const GainSchedule& schedule,
                  std::span<const double> quiet_misfit, ModelBasedResult& result);

/// A steady force F lifts R₁ by −(1 − x_c/L) F and R₂ by −(x_c/L) F: both offsets measure it.
StaticRecovery static_recovery(const ObservedRecord& record, const ModelBasedResult& result);

/// "friction law: thermal; …": the law named and those it was held against.
std::string law_note(const ModelBasedResult& result);

/// Warns of a misfit above its limit, and of offsets that left the level before the first wave by
/// more than five of their deviations [N].
void add_warnings(const ModelBasedOptions& options, const ObservedRecord& record,
                  std::span<const double> offset_deviation, ModelBasedResult& result);

/// The joint estimate of a record with the variances of its bins: what the observer is held
/// against, since it assumes no friction law. `noise_rms` as stated [N]; NaN: from the record.
Estimate joint_estimate(const EstimationModel& model, const ReactionPair& reactions,
                        const double (&noise_rms)[2]);

/// The noise levels of the joint estimate, which knows what the string itself leaves above its
/// modes, where none is stated.
void take_noise(const Estimate& joint, const double (&stated)[2], ObservedRecord& record);

/// What force and velocity are off by as measured against the joint estimate (band_errors()), up to
/// its band limit or the highest mode. The deviations of the motion grow by it and, where the
/// misfit is above its limit, by what the sensors' noise cannot explain: √(noise² misfit/limit +
/// error²).
void add_model_error(Estimate joint, const ObservedRecord& record, ModelBasedResult& result);

/// Stiffness of a contact that gives way less than this is of no consequence to any mode [N/m]:
/// its resonance on the string's effective mass is kRigid times above the highest mode.
double rigid_stiffness(const ObserverRuns& runs);

/// Throws InvalidInput for a contact stiffness above rigid_stiffness() which the innovations do not
/// hold from growing further: it has no finite optimum, and the contact's resonance is above the
/// rate of the observer's steps.
void require_finite_stiffness(const ObserverRuns& runs, const ObserverParameters& parameters,
                              const GainSchedule& schedule);

/// Mean power of a force's spectrum in the last tenth below half the sample rate over that between
/// 60 and 85 % of it: at most about 1 for a force that jumps and slides.
double ringing(std::span<const double> force);

/// Throws InvalidInput where ringing() is above kMostRinging.
void require_no_ringing(std::span<const double> force, double sample_rate);

}  // namespace modcal::observer
