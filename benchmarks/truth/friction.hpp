// Friction at the contact as a set of forces, solved for together with the string.
#pragma once

#include <variant>

namespace modcal::truth {

/// Coulomb friction that falls exponentially with the sliding speed u, μ(u) = μ_D + (μ_S − μ_D)
/// e^{−Cu} (Debut, Delaune and Antunes, 2010, eq. 7; a curve of the kind that Smith and Woodhouse,
/// 2000, measured in steady sliding).
struct ExponentialFriction {
  double static_coefficient = 0.4;   ///< μ_S [1]
  double dynamic_coefficient = 0.2;  ///< μ_D [1], at most μ_S
  double decay = 5.0;                ///< C [s/m]
};

/// Rosin that softens: μ depends on the contact's temperature rise ϑ [K] alone,
///
///     μ(ϑ) = μ_hot + (μ_cold − μ_hot)/(1 + e^{(ϑ − ϑ_s)/w}),    H ϑ' = |f u| − (G + S u) ϑ
///
/// (Woodhouse, 2003, Bowed string simulation using a thermal friction model, Acta Acust. united Ac.
/// 89, 355–368, with one heat capacity in the place of his Green's function of conduction).
struct ThermalFriction {
  double cold_coefficient = 0.8;  ///< μ_cold [1]
  double hot_coefficient = 0.2;   ///< μ_hot [1], at most μ_cold
  double softening_rise = 20.0;   ///< ϑ_s [K]
  double softening_width = 6.0;   ///< w [K]
  double heat_capacity = 5e-6;    ///< H [J/K]
  double conductance = 2e-3;      ///< G [W/K]
  double carried_heat = 1e-3;     ///< S [J/(K m)]
};

using Friction = std::variant<ExponentialFriction, ThermalFriction>;

/// What the string offers: its contact would move at `free_velocity` [m/s] without force and moves
/// by `mobility` [m/s/N] more for each newton. And what the bow does.
struct ContactLoad {
  double free_velocity;
  double mobility;
  double bow_velocity;
  double normal_force;  ///< ≥ 0 [N]
};

/// Force on the string [N] and velocity of the string relative to the bow [m/s].
struct ContactState {
  double force = 0.0;
  double slip = 0.0;
  bool stuck = false;
};

/// The contact: f ∈ −N μ(|r|) sgn(r), and for r = 0 the whole interval |f| ≤ N μ(0).
class Contact {
 public:
  /// Throws std::invalid_argument for coefficients out of order.
  Contact(const Friction& friction, double time_step);

  /// Intersection of load line and friction set. With N Y max|μ'| < 1 there is one and only one
  /// (Friedlander's ambiguity does not arise: the line of one time step is steep); throws
  /// std::invalid_argument otherwise. Advances the temperature by one time step, by backward Euler.
  ContactState solve(const ContactLoad& load);

  /// μ(u) at the temperature of the last solve(), μ(0) for sticking [1].
  double last_coefficient(double speed) const;
  double temperature() const { return temperature_; }  ///< ϑ [K]

 private:
  ContactState slide(const ContactLoad& load, double relative) const;

  Friction friction_;
  double time_step_;
  double temperature_ = 0.0, last_temperature_ = 0.0;
};

}  // namespace modcal::truth
