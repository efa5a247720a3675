// Constants that were chosen, not derived.
#pragma once

namespace modcal {

/// Calls of the sliding law by which its time is measured for a plan.
/// Source: not derived; about a millisecond, far above the clock's resolution.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kTimedCalls = 20000;

}  // namespace modcal
