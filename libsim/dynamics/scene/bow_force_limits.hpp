// Between which bow forces a string keeps up Helmholtz motion.
#pragma once

#include "libsim/dynamics/scene/scene.hpp"

namespace modcal {

struct BowForceLimits {
  double lowest = 0.0;   ///< below it the string slips more than once a period [N]
  double highest = 0.0;  ///< above it the corner cannot release the string [N]
};

/// Schelleng's bow-force limits (Schelleng, 1973), with β = x_c/L, the characteristic
/// impedance Z₀ = √(T ρ_L) and Δμ = μ_S − μ(v_b(1 − β)/β), the friction coefficient's fall from its
/// static value to the one at the slip speed of Helmholtz motion:
///   highest = 2 Z₀ v_b/(β Δμ),      lowest = Z₀² v_b/(2 R β² Δμ).
/// His loss, a resistance R at the bridge, gives every mode the damping ratio ζ_n = Z₀/(π n R).
/// Carried out for any damping ratios his argument (the force that feeds each harmonic of Helmholtz
/// motion, half a period after the slip against the one in it) reads
///   lowest = 4 Z₀ v_b/(π β² Δμ) Σ_{n odd ≤ 1/β} ζ_n/n,
/// which is his for his loss since Σ_{n odd} 1/n² = π²/8.
/// Throws InvalidInput for a contact outside the string. Infinite where Δμ = 0.
BowForceLimits schelleng_limits(const Scene& scene);

}  // namespace modcal
