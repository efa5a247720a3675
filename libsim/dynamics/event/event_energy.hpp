// Energies of an event-driven run, integrated over its own steps.
#pragma once

#include <cmath>
#include <cstddef>

namespace modcal {

/// Energies in J over a whole run. With f the force that acted, F(u) the friction law, y_c and v_c
/// elongation and velocity of the contact's spring and damper:
///   string   string_work = dissipated + stored,
///   contact  bow_work + wound = string_work + friction + damper + dropped + spring.
/// The string's balance is exact. The contact's is where the force obeys the law at every instant;
/// it does at the nodes of a sliding step and errs between them, which is what `defect` and, with
/// signs that cancel, contact_residual() measure.
struct EventEnergy {
  double bow_work = 0.0;     ///< ∫ f v_bow dt
  double string_work = 0.0;  ///< ∫ f v dt
  double friction = 0.0;     ///< ∫ F(u) u dt while sliding
  double damper = 0.0;       ///< ∫ C_a v_c² dt while sticking
  double spring = 0.0;      ///< growth of ½ K_a y_c² of an adherence at the end over one at t = 0
  double dropped = 0.0;     ///< ½ K_a y_c² that adherence springs held as they were let go
  double wound = 0.0;       ///< ½ K_a y_c² that they were given at attachments (continuous rule)
  double dissipated = 0.0;  ///< Σ ∫ 2 ζ_n ω_n m_n q̇_n² dt
  /// Growth of Σ m_n (q̇_n² + ω_n² q_n²)/2 from the start to the integrator's own final state.
  double stored = 0.0;

  double throughput = 0.0;          ///< ∫ |f v| dt
  double bow_throughput = 0.0;      ///< ∫ |f v_bow| dt
  double contact_throughput = 0.0;  ///< ∫ |f v_c| dt
  double largest_stored = 0.0;      ///< stored energy at the start and at the end, the larger
  /// ∫ |f − f_law(v_c, y_c)| |v_c| dt: what the collocation misses of the contact law, at most.
  double defect = 0.0;
  /// ∫ of H ϑ' − F(u) u + (G + S u) ϑ over every step, their magnitudes: heat of a contact with a
  /// temperature that its equation does not explain.
  double heat_residual = 0.0;
  std::size_t pieces = 0;           ///< stretches integrated
  double pieces_and_radians = 0.0;  ///< their number and the radians of the fastest mode in them

  double string_residual() const { return string_work - dissipated - stored; }
  double contact_residual() const {
    return bow_work + wound - string_work - friction - damper - dropped - spring;
  }
  /// Of both together: bow_work + wound − friction − damper − dropped − spring − dissipated −
  /// stored.
  double residual() const { return string_residual() + contact_residual(); }
  double string_at_hand() const { return throughput + dissipated + largest_stored; }
  double contact_at_hand() const { return throughput + bow_throughput + contact_throughput; }
  /// What |string_residual()| may be by rounding: 4·2⁻⁵² of all energy at hand for every piece and
  /// radian of the fastest mode.
  double string_bound() const { return rounding() * string_at_hand(); }
  /// What |contact_residual()| may be: the defect, and rounding alike.
  double contact_bound() const { return defect + rounding() * contact_at_hand(); }

 private:
  double rounding() const { return 8.9e-16 * pieces_and_radians; }
};

}  // namespace modcal
