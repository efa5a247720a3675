// Constants that were chosen, not derived.
#pragma once

namespace modcal {

/// Shape at the contact below which a mode has a node there, and the shape that stands in for it
/// [1]: nothing is driven, and no number is 0.
/// Source: some hundreds of a double's rounding; its square is far below any other.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kNodeTolerance = 1e-13;
constexpr double kNodeStandIn = 1e-20;

/// Shortest and longest period of a motion, over that of the string, that is looked for.
/// Source: not derived.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kShortestPeriod = 0.8;
constexpr double kLongestPeriod = 1.25;

/// Difference of two correlations that are equal. A motion that repeats itself n times in a period
/// correlates as well over (n ± 1)/n of one: among equals the period nearest to the string's is
/// taken.
/// Source: not derived.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kEqualCorrelation = 0.02;

/// Periods of the string at the end of the record that are left out, as the last judged slip may go
/// on beyond the end.
/// Source: not derived; a slip is shorter than a period.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kSparePeriods = 1.5;

}  // namespace modcal
