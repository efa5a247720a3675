// Constants that were chosen, not derived.
#pragma once

#include <cstddef>

namespace modcal {

/// Distance of a mode's pole from the center of a block, in half-widths of the block, from which on
/// the mode is interpolated between Chebyshev nodes (WhitenedRecord::kNodes).
/// Source: Bernstein's ellipse of the pole: (4 + √15)^-16 = 5e-15 of the mode is left.
/// Range tried: this.
/// Doubled: 6e-20 by that bound, with more modes near.
/// Halved: 7e-10 by that bound.
constexpr double kFarMode = 4.0;

/// Far modes of a block below which they are evaluated in its bins as near ones are.
/// Source: not derived; going to the nodes and back costs about as much as some modes in all bins.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kFewestFarModes = 12;

}  // namespace modcal
