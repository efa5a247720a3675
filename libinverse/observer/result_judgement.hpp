// What a model-based result says about itself.
#pragma once

#include <span>

#include "libinverse/observer/model_based_estimator.hpp"
#include "libinverse/observer/observed_record.hpp"
#include "libinverse/observer/observer_runs.hpp"

namespace modcal::observer {

/// Fills the misfit that a right model leaves and its deviation: what the gains let in of the noise
/// (`quiet_misfit`, one a gain), by the share of the blocks each gain serves; the scatter of the
/// median over blocks, √(π/2) that of the mean, and that of the noise levels it is relative to.
void judge_misfit(const ObservedRecord& record, const GainSchedule& schedule,
                  std::span<const double> quiet_misfit, ModelBasedResult& result);

/// A steady force F lifts R₁ by −(1 − x_c/L) F and R₂ by −(x_c/L) F: both offsets measure it.
StaticRecovery static_recovery(const ObservedRecord& record, const ModelBasedResult& result);

/// Warns of a misfit above its limit, and of offsets that left the level before the first wave by
/// more than five of their deviations [N].
void add_warnings(const ModelBasedOptions& options, const ObservedRecord& record,
                  std::span<const double> offset_deviation, ModelBasedResult& result);

}  // namespace modcal::observer
