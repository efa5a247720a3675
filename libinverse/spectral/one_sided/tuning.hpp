// Constants that were chosen, not derived.
#pragma once

#include <cstddef>

namespace modcal {

/// Relative step by which filter factors are differentiated by their singular values, central
/// differences.
/// Source: the cube root of a double's rounding is 6e-6.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kScaleStep = 1e-5;

/// Bins of a task of a scan, a multiple of kBinLanes. It tells in which order sums are added.
/// Source: some ten microseconds of work for 50 modes and 50 candidates.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kScanBlock = 96;

}  // namespace modcal
