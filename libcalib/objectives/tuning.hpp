// Constants that were chosen, not derived.
#pragma once

namespace modcal {

/// Samples at the end of a record that are left out besides those that a delay brings there.
/// Source: what a shift in time makes up at the end fades as 1/n² with the distance n from it:
/// 1/256.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kShiftFaded = 16.0;

}  // namespace modcal
