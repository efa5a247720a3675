// Energy of a simulated string: where the bow's work has gone.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "libsim/base/aligned_vector.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/dynamics/scene/simulation.hpp"

namespace modcal {

/// Gauss–Legendre quadrature on [0, 1].
struct GaussRule {
  std::vector<double> node, weight;
};

/// n points, exact for polynomials of degree 2n − 1: the roots of P_n by Newton's method from
/// cos(π (i + ¾)/(n + ½)) (Abramowitz and Stegun, 1964, 25.4.30).
GaussRule gauss_rule(int points);

/// Σ powers[p] θ^p.
inline double power_sum(std::span<const double> powers, double theta) {
  double sum = 0.0;
  for (std::size_t p = powers.size(); p-- > 0;) sum = sum * theta + powers[p];
  return sum;
}

/// Coefficients of the powers of θ ∈ [0, 1], for one contact point each.
using PointPowers = std::vector<std::vector<double>>;

/// Modes Z' = λ Z + Σ_j φ_j f_j/m under forces given as power series in time. On a piece of length
/// h each mode is the series z_{p+1} = (λh z_p + h Σ_j φ_j f_jp/m)/(p + 1), taken to where its rest
/// is below rounding; dissipation is integrated by Gauss's rule. None of the simulators'
/// propagators is used.
class ModeReplay {
 public:
  /// Longest piece, |λ|h; longer ones are for the caller to divide.
  static constexpr double kLongestPhase = 4.0;

  explicit ModeReplay(const ContactModes& modes);
  explicit ModeReplay(const LineModes& modes);

  /// max |λ| [1/s].
  double fastest() const { return fastest_; }
  /// Moves on by `time` [s] under f_j(θ) = Σ force[j][k] θ^k, at most 25 coefficients. Returns the
  /// dissipation Σ ∫ 2ζω m p² dt [J] and writes v_j(θ) = Σ velocity[j][p] θ^p of the points [m/s].
  double advance(double time, std::span<const std::span<const double>> force,
                 PointPowers& velocity);
  /// Σ m (p² + ω² q²)/2 [J] of the present state, and of any state Z of these modes.
  double energy() const;
  double energy(const PlanarVector& state) const;

 private:
  ModeReplay(const ModeTable& modes, const std::vector<double>& inverse_mass,
             const std::vector<std::vector<double>>& shape);
  static std::size_t terms(double phase, std::size_t forces);
  double energy_of(std::size_t mode, std::complex<double> state) const;

  ModeTable modes_;
  std::vector<double> inverse_mass_;
  std::vector<std::vector<double>> shape_;
  std::vector<std::complex<double>> state_;
  double fastest_ = 0.0;
  GaussRule few_, many_;
};

/// Energies in J over a whole run. The string's balance is string_work = dissipated + stored.
struct EnergyBalance {
  double bow_work = 0.0;            ///< ∫ f_c v_bow dt
  double string_work = 0.0;         ///< ∫ f_c v dt, v as the simulator gave it
  double dissipated = 0.0;          ///< Σ ∫ 2 ζ_n ω_n m_n q̇_n² dt
  double stored = 0.0;              ///< growth of Σ m_n (q̇_n² + ω_n² q_n²)/2
  double throughput = 0.0;          ///< ∫ |f_c v| dt
  double contact_throughput = 0.0;  ///< ∫ |f_c (v − v_bow)| dt
  double largest_stored = 0.0;      ///< stored energy at the start and at the end, the larger

  double string_residual() const { return string_work - dissipated - stored; }
  double string_at_hand() const { return throughput + dissipated + largest_stored; }
};

/// Energies of a record, sums over the contact points.
struct EnergyAccount : EnergyBalance {
  /// What string_residual() may be by rounding: 4·2⁻⁵² of all energy at hand for every step and
  /// radian of the fastest mode in it.
  double rounding = 0.0;
  /// −∫ f_c (v − v_bow) dt: friction, adherence damper and spring.
  double contact_loss() const { return bow_work - string_work; }
};

/// Energies of an event-driven run, over its own steps. With f the force that acted, F(u) the
/// friction law, y_c and v_c elongation and velocity of the contact's spring and damper, the
/// contact's balance is
///   bow_work + wound = string_work + friction + damper + dropped + spring.
/// The string's balance is exact. The contact's is where the force obeys the law at every instant;
/// it does at the nodes of a sliding step and errs between them, which is what `defect` and, with
/// signs that cancel, contact_residual() measure.
struct EventEnergy : EnergyBalance {
  double friction = 0.0;  ///< ∫ F(u) u dt while sliding
  double damper = 0.0;    ///< ∫ C_a v_c² dt while sticking
  double spring = 0.0;    ///< growth of ½ K_a y_c² of an adherence at the end over one at t = 0
  double dropped = 0.0;   ///< ½ K_a y_c² that adherence springs held as they were let go
  double wound = 0.0;     ///< ½ K_a y_c² that they were given at attachments (continuous rule)
  double bow_throughput = 0.0;  ///< ∫ |f v_bow| dt
  /// ∫ |f − f_law(v_c, y_c)| |v_c| dt: what the collocation misses of the contact law, at most.
  double defect = 0.0;
  /// ∫ of H ϑ' − F(u) u + (G + S u) ϑ over every step, their magnitudes: heat of a contact with a
  /// temperature that its equation does not explain.
  double heat_residual = 0.0;
  std::size_t pieces = 0;           ///< stretches integrated
  double pieces_and_radians = 0.0;  ///< their number and the radians of the fastest mode in them

  double contact_residual() const {
    return bow_work + wound - string_work - friction - damper - dropped - spring;
  }
  /// Of both together: bow_work + wound − friction − damper − dropped − spring − dissipated −
  /// stored.
  double residual() const { return string_residual() + contact_residual(); }
  double contact_at_hand() const { return throughput + bow_throughput + contact_throughput; }
  /// What |string_residual()| may be by rounding: 4·2⁻⁵² of all energy at hand for every piece and
  /// radian of the fastest mode.
  double string_bound() const { return rounding() * string_at_hand(); }
  /// What |contact_residual()| may be: the defect, and rounding alike.
  double contact_bound() const { return defect + rounding() * contact_at_hand(); }

 private:
  double rounding() const { return 8.9e-16 * pieces_and_radians; }
};

/// How the force of a record drives the string between two samples.
enum class ForceHold {
  kLinear,  ///< it goes straight from one sample to the next (modal_exact)
  kLagged,  ///< step k feels (f_{k−2} + f_{k−1})/2, trapezoidal rule (newmark_explicit)
};

/// Motion and force of one contact point at every step of a simulation.
struct PointRecord {
  std::span<const double> displacement;  ///< y_j [m]
  std::span<const double> velocity;      ///< v_j [m/s]
  std::span<const double> force;         ///< f_j [N]
};

/// Replays the modes, torsional ones included, under the forces of the contact points, sampled at
/// every step, apart from the simulator's own arithmetic: by power series (ModeReplay) where the
/// force is straight, by the discrete identities of the trapezoidal rule for kLagged. The bow may
/// move as it likes; its work is exact where no knot of its gesture lies inside a step. What the
/// friction law is does not matter.
/// modes: of the scene, with the points' shapes; points: one record each, of equal length; ≥ 1
/// sample. Throws InvalidInput otherwise. modal_event accounts for itself
/// (simulate_audited() in energy_meter.hpp): its force is not known from samples.
EnergyAccount audit_energy(const LineModes& modes, const BowMotion& bow,
                           std::span<const PointRecord> points, double sample_rate, ForceHold hold);

/// The same for a bow of one contact point. `run` needs displacement, velocity and force.
EnergyAccount audit_energy(const Scene& scene, const Simulation& run, ForceHold hold);

}  // namespace modcal
