// Constants that were chosen, not derived.
#pragma once

#include <cstddef>

namespace modcal {

/// Lobes of the window on either side by which draws of noise become a band-limited gesture, and
/// straight pieces between two draws.
/// Source: not derived.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kNoiseLobes = 8;
constexpr std::size_t kNoisePieces = 8;

/// Straight pieces of a period of a sine.
/// Source: a chord is off by at most (2π/128)²/8 = 3e-4 of the amplitude.
/// Range tried: this.
/// Doubled: 8e-5 by that formula.
/// Halved: 1.2e-3.
constexpr double kPiecesPerPeriod = 128.0;

}  // namespace modcal
