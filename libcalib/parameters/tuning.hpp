// Constants that were chosen, not derived.
#pragma once

#include <cstddef>

namespace modcal {

/// Gauss–Newton steps by which f0 and B are fitted to frequencies, at most.
/// Source: not derived; an end, a fit that converges needs fewer.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kLineFitSteps = 50;

}  // namespace modcal
