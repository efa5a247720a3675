// Constants that were chosen, not derived.
#pragma once

namespace modcal::event {

/// Share of the velocities at hand below which the relative velocity v_c is zero.
/// Source: some tens of a double's rounding.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kAtRest = 1e-14;

/// Positions in a grid step closer than this are one [grid steps].
/// Source: some hundreds of a double's rounding.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kSamePoint = 1e-13;

/// Largest |μ|h [rad] of a power series of the held string, of 25 terms.
/// Source: 1.6²⁵/25! = 8e-21 of its size is left out.
/// Range tried: this.
/// Doubled: 3e-13 is left out.
/// Halved: 2e-28, in steps half as long.
constexpr double kStickingPhase = 1.6;

/// Force at the attachment that is the limit but for this share of it: the continuous rule.
/// Source: some thousands of a double's rounding, as sums over all modes make the force.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kAtLimit = 1e-12;

/// What a series of the force that is shown may leave out, over the limit.
/// Source: a tenth of a double's rounding.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kLeftOutOfSeries = 1e-17;

/// Largest |μ|h of the held string in a step [rad]: a stiffer contact is refused.
/// Source: not derived; a phase of 1e4 has lost four digits of sixteen.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kMostStickingPhase = 1e4;

}  // namespace modcal::event
