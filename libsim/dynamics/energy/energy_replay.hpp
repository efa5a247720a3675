// One mode replayed under a recorded force, in arithmetic of its own.
#pragma once

#include <complex>
#include <span>

namespace modcal {

/// How the force of a record drives the string between two samples.
enum class ForceHold {
  kLinear,  ///< it goes straight from one sample to the next (modal_exact)
  kLagged,  ///< step k feels (f_{k−2} + f_{k−1})/2, trapezoidal rule (newmark_explicit)
};

/// A mode Z' = λ Z + load, Z = p + ζω q + i ω_d q, velocity p = Re Z − κ Im Z, displacement
/// q = Im Z/ω_d.
struct ReplayedMode {
  std::complex<double> pole;     ///< λ [1/s]
  double quadrature = 0.0;       ///< κ = ζω/ω_d [1]
  double compliance = 0.0;       ///< 1/ω_d [s]
  std::complex<double> initial;  ///< Z at t = 0 [m/s]
};

/// Of unit modal mass.
struct ModeAccount {
  double work = 0.0;       ///< ∫ load p dt [m²/s²]; 0 for kLagged
  double square = 0.0;     ///< ∫ p² dt [m²/s]
  double start = 0.0;      ///< (p² + ω² q²)/2 at the start [m²/s²]
  double end = 0.0;        ///< and at the end
  double loss_rate = 0.0;  ///< 2 ζ ω: what the mode loses is this times `square` [1/s]
};

/// Replays a mode under the load [m/s²] at the samples, `step` [s] apart: exactly where the load is
/// straight (closed-form integrals of e^{λt} where |λ|h > 8, 6-point Gauss quadrature on substeps
/// of |λ|δ ≤ 1, error 1e-12, below), by the discrete identities of the trapezoidal rule for
/// kLagged. Writes the velocity p at the samples, but for kLagged.
ModeAccount replay(const ReplayedMode& mode, std::span<const double> load, double step,
                   ForceHold hold, std::span<double> velocity);

/// Mean force of the step after sample k for kLagged; no force is known before t = 0.
double lagged_force(std::span<const double> force, std::size_t k);

}  // namespace modcal
