// Angles of a full turn.
#pragma once

#include <numbers>

namespace modcal {

inline constexpr double kTurn = 2.0 * std::numbers::pi;  ///< [rad]: ω = kTurn f

}  // namespace modcal
