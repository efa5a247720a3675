// Energy of a finished simulation, from its force record alone.
#pragma once

#include <span>

#include "libsim/dynamics/gestures/bow.hpp"
#include "libsim/dynamics/energy/energy_replay.hpp"
#include "libsim/dynamics/fixed_step/line_modes.hpp"
#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

/// Motion and force of one contact point at every step of a simulation.
struct PointRecord {
  std::span<const double> displacement;  ///< y_j [m]
  std::span<const double> velocity;      ///< v_j [m/s]
  std::span<const double> force;         ///< f_j [N]
};

/// Energies in J over a whole record, sums over the contact points. The string's balance is
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
  /// string_work − dissipated − stored.
  double residual() const { return string_work - dissipated - stored; }
};

/// Replays the modes, torsional ones included, under the forces of the contact points, sampled at
/// every step, apart from the simulator's own arithmetic (energy_replay.hpp), and accounts for
/// every mode exactly. The bow may move as it likes; its work is exact where no knot of its gesture
/// lies inside a step. What the friction law is does not matter.
/// modes: of the scene, with the points' shapes; points: one record each, of equal length; ≥ 1
/// sample. Throws InvalidInput otherwise. modal_event accounts for itself
/// (ModalEvent::simulate_audited): its force is not known from samples.
EnergyAccount audit_energy(const LineModes& modes, const BowMotion& bow,
                           std::span<const PointRecord> points, double sample_rate, ForceHold hold);

/// The same for a bow of one contact point. `run` needs displacement, velocity and force.
EnergyAccount audit_energy(const Scene& scene, const Simulation& run, ForceHold hold);

}  // namespace modcal
