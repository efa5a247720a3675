// Constants that were chosen, not derived.
#pragma once

namespace modcal::event {

/// Distance from the grid [grid steps] below which a knot of the bow's path lies on it.
/// Source: not derived; rounding of an instant after 10^6 steps is 2e-10 of one.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kOnGrid = 1e-9;

/// Condition of a root of the held string, in the energy norm, from which on its closed loop is
/// refused.
/// Source: half of a double's digits are left.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kWorstCondition = 1e8;

/// Relative error of a state that goes to the coordinates of the held string and back, above which
/// they are not complete: a root is wrong, missing or listed twice.
/// Source: not derived; a missing root leaves all of a mode, the worst condition 1e-8.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kWorstRoundTrip = 1e-7;

/// Leading coefficients that are rounding beside the largest one, at a start known to be zero.
/// Source: some hundreds of a double's rounding.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kVanishing = 1e-13;

/// Steps towards the first crossing of a polynomial, at most.
/// Source: not derived; an end.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kCrossingSteps = 300;

/// Sweeps over all roots of the held string, at most.
/// Source: not derived; an end, the iteration is cubic.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kRootSweeps = 200;

/// |Im μ| below this share of |μ| is rounding of a real root.
/// Source: not derived.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kRealRoot = 1e-9;

}  // namespace modcal::event
