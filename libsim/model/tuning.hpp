// Constants that were chosen, with what changes where they are doubled and halved. Errors are the
// largest of the six strings of higher_modes_test, in static forces.
#pragma once

#include <cstddef>

namespace modcal {

/// Points that interpolate the modes above the last one that stands for itself.
/// Source: Bernstein's ellipse of the interpolation's pole, see below; 2.9e-7 as it is.
/// Range tried: 5 to 20.
/// Doubled: 2.8e-7.
/// Halved: 7.9e-5.
constexpr std::size_t kRemainderPoints = 10;

/// λ of the interpolation's pole over its interval's end: how far above the band modes stand for
/// themselves.
/// Source: the same ellipse: 4.2 at 1.6, so that ten points leave 4.2^-10 = 6e-7 of the sum.
/// Range tried: 1.25 to 3.2.
/// Doubled: 1.4e-7, with 40 % more modes apart.
/// Halved: not possible, the pole must lie outside the interval; at 1.25 4.3e-6.
constexpr double kRemainderApart = 1.6;

/// Modes of the second sum, whose terms fall as n^-3.
/// Source: what is left of it is below (f/f0)²/1500³ times the inverse of 2 sin(θ/2).
/// Range tried: 750 to 3000.
/// Doubled: 2.6e-8, at twice the time.
/// Halved: 1.3e-6.
constexpr std::size_t kRemainderModes = 1500;

/// The constant's mode, in band ends: it differs from a constant by its inverse square.
/// Source: 1e-10 of a static force is below every other error here.
/// Range tried: 5e4 to 2e5.
/// Doubled: 2.9e-7.
/// Halved: 2.9e-7.
constexpr double kRemainderConstantAt = 1e5;

}  // namespace modcal
