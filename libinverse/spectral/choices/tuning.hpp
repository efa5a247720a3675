// Constants that were chosen, not derived.
#pragma once

namespace modcal {

/// Share of the largest singular value below which the automatic range of the parameter does not
/// reach.
/// Source: not derived; the root of a double's rounding.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kLowestParameterShare = 1e-8;

/// Ratio of two parameters from which on their rules disagree, which is said.
/// Source: not derived.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kRulesApart = 10.0;

}  // namespace modcal
