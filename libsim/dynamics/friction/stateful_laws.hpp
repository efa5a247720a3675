// Friction laws with a state of their own, as plain values for the step loops: no virtual call, no
// allocation.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "libsim/base/decaying_exp.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"

namespace modcal {

/// Friction coefficient that depends on the temperature of the contact alone, its rise ϑ above the
/// surroundings [K] being a state:
///   μ(ϑ) = μ_hot + (μ_cold − μ_hot)/(1 + e^((ϑ − ϑ_s)/w)),   f = −sgn(v_c) μ(ϑ) F_N,
///   H ϑ' = |f v_c| − (G + S |v_c|) ϑ   while sliding, H ϑ' = −G ϑ while sticking.
struct ThermalSliding {
  double hot = 0.0, drop = 0.0;                    ///< μ_hot, μ_cold − μ_hot [1]
  double softening = 25.0, softening_width = 5.0;  ///< ϑ_s, w [K]
  double capacity = 1.0;                           ///< H [J/K]
  double conductance = 0.0;                        ///< G [W/K]
  double carried = 0.0;                            ///< S [J/(K m)]
  double rise = 0.0;                               ///< ϑ [K]

  /// (μ − μ_hot)/(μ_cold − μ_hot) at the rise ϑ.
  double cold_share(double at_rise) const {
    return 1.0 / (1.0 + std::exp((at_rise - softening) / softening_width));
  }
  struct Softening {
    double coefficient;  ///< μ(ϑ)
    double slope;        ///< dμ/dϑ ≤ 0 [1/K]
  };
  Softening softening_at(double at_rise) const {
    const double share = cold_share(at_rise);
    return {hot + drop * share, -drop * share * (1.0 - share) / softening_width};
  }
  SlidingPoint at(double /*speed*/) const { return {softening_at(rise).coefficient, 0.0, 0.0}; }
  /// Advances ϑ by h [s] at the sliding speed u ≥ 0 [m/s] under the friction force |f| [N]; exact
  /// where both are steady. Nothing is rubbed, and no heat carried off, where there is no force.
  void advance(double h, double speed, double force) {
    const double rate = (conductance + (force > 0.0 ? carried * speed : 0.0)) / capacity;
    const double change = force * speed / capacity - rate * rise;
    rise += rate * h > 0.0 ? -change * std::expm1(-rate * h) / rate : change * h;
  }
  /// The law of one of several equal parts of the contact.
  ThermalSliding share(double part) const {
    ThermalSliding law = *this;
    law.capacity *= part;
    law.conductance *= part;
    law.carried *= part;
    return law;
  }
};

/// Elasto-plastic bristles with the mean deflection z [m] as a state:
///   f = −(σ₀ z + σ₁ z'),   z' = v_c (1 − α |σ₀ z|/g(v_c)) with the sign of z in that of v_c,
///   g(v) = F_N [μ_D + (μ_S − μ_D) exp(−(v/v_s)²)],
/// α = 1 at |z| ≥ g/σ₀, 0 below the breakaway deflection and where v_c unloads the bristle, half a
/// sine wave between; α = 1 throughout makes it the LuGre model. σ₁ is at most 4 g(v)/|v|, the
/// largest for which the model is passive (elasto_plastic.hpp).
struct BristleFriction {
  double dynamic_coefficient = 0.0, drop = 0.0;  ///< μ_D, μ_S − μ_D [1]
  double stribeck_speed = 0.1;                   ///< v_s [m/s]
  double stiffness = 1e5;                        ///< σ₀ [N/m]
  double damping = 0.0;                          ///< σ₁ [N s/m]
  double breakaway = -1.0;  ///< breakaway deflection over μ_D F_N/σ₀ [1]; < 0: α = 1
  double deflection = 0.0;  ///< z [m]

  double steady_force(double slip, double normal_force) const {
    const double ratio = slip / stribeck_speed;
    return normal_force * (dynamic_coefficient + drop * decaying_exp(-ratio * ratio));
  }
  /// α for the deflection z.
  double plasticity(double slip, double normal_force) const {
    if (breakaway < 0.0) return 1.0;
    if (slip * deflection <= 0.0) return 0.0;
    const double z = std::abs(deflection) * stiffness;
    const double low = breakaway * dynamic_coefficient * normal_force;
    const double high = steady_force(slip, normal_force);
    if (z >= high) return 1.0;
    if (z <= low) return 0.0;
    return 0.5 + 0.5 * std::sin(std::numbers::pi * (z - 0.5 * (high + low)) / (high - low));
  }

  struct Step {
    double deflection, force;
  };
  /// Deflection and force after a step h at the end of which the slip velocity is `slip`: backward
  /// Euler with the α of the step's start, |z| ≤ μ_S F_N/σ₀, which no bristle passes but by a step
  /// that jumps over its yielding. For every state and step the work of the slip, −f·slip·h, is at
  /// least the change of ½ σ₀ z².
  Step step(double h, double slip, double normal_force) const {
    if (!(normal_force > 0.0)) return {0.0, 0.0};
    const double speed = std::abs(slip), g = steady_force(slip, normal_force);
    const double yielding = plasticity(slip, normal_force) * speed * stiffness / g;
    const double most = (dynamic_coefficient + drop) * normal_force / stiffness;
    const double z = std::clamp((deflection + h * slip) / (1.0 + h * yielding), -most, most);
    const double rate = slip - yielding * z;
    const double damper = damping * speed <= 4.0 * g ? damping : 4.0 * g / speed;
    return {z, -(stiffness * z + damper * rate)};
  }
  BristleFriction share(double part) const {
    BristleFriction law = *this;
    law.stiffness *= part;
    law.damping *= part;
    return law;
  }
};

/// A friction law with a state; std::monostate: the law has none.
using StatefulLaw = std::variant<std::monostate, ThermalSliding, BristleFriction>;

}  // namespace modcal
