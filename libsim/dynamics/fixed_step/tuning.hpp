// Constants that were chosen, not derived.
#pragma once

namespace modcal {

/// Gauss–Seidel sweeps over the forces of the contact points in a step, at most.
/// Source: not derived; an end, they contract where the step resolves the adherence.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kPointSweeps = 200;

}  // namespace modcal
