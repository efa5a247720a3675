// Energy of a finished simulation, from its force record alone.
#pragma once

#include <vector>

#include "libsim/dynamics/contact_modes.hpp"
#include "libsim/dynamics/simulator.hpp"

namespace modcal {

/// How the force of a record drives the string between two samples.
enum class ForceHold {
  kLinear,   ///< it goes straight from one sample to the next (modal_exact)
  kSampled,  ///< unknown between samples, taken as straight (modal_event)
  kLagged,   ///< step k feels (f_{k−2} + f_{k−1})/2, trapezoidal rule (newmark_explicit)
};

/// Energies in J over a whole record. The string's balance is
/// string_work = dissipated + stored, the contact's bow_work = string_work + contact_loss.
struct EnergyAccount {
  double bow_work = 0.0;      ///< ∫ f_c v_bow dt
  double string_work = 0.0;   ///< ∫ f_c v dt, v as the simulator gave it
  double contact_loss = 0.0;  ///< −∫ f_c (v − v_bow) dt: friction, adherence damper and spring
  double dissipated = 0.0;    ///< Σ ∫ 2 ζ_n ω_n m_n q̇_n² dt
  double stored = 0.0;        ///< growth of Σ m_n (q̇_n² + ω_n² q_n²)/2
  double throughput = 0.0;    ///< ∫ |f_c v| dt
  double contact_throughput = 0.0;  ///< ∫ |f_c (v − v_bow)| dt
  double largest_stored = 0.0;      ///< stored energy at the start and at the end, the larger
  /// What the balance may miss by rounding: 4·2⁻⁵² of all energy at hand for every step and radian
  /// of the fastest mode in it.
  double rounding = 0.0;
  /// What it may miss because the force between samples is not known (kSampled): Σ |Δ²f| h (max|v|
  /// + max|f| Σ φ²/(mω)). A force that bends or jumps between samples is off the straight line by
  /// |Δ²f| at most; that does the work |Δ²f| h max|v| itself, and its impulse moves the contact by
  /// Σ φ²/(mω) times it, against max|f|. Samples further apart than a radian of the fastest mode
  /// say nothing of the force between them: 2 max|f| for every step.
  double interpolation = 0.0;
  /// string_work − dissipated − stored.
  double residual() const { return string_work - dissipated - stored; }
};

/// Replays the modes under the force of `run`, sampled at every step, apart from the simulator's
/// own arithmetic, and accounts for every mode exactly: closed-form integrals of e^{λt} where
/// |λ|h > 8, 6-point Gauss quadrature on substeps of |λ|δ ≤ 1 (error 1e-12) below; discrete
/// identities of the trapezoidal rule for kLagged.
/// `run` needs displacement, velocity and force; throws InvalidInput without them.
EnergyAccount audit_energy(const ContactModes& modes, const Simulation& run, double bow_velocity,
                           ForceHold hold);

}  // namespace modcal
