// Friction laws as plain values for the step loops, of the sliding speed alone and with a state: no
// virtual call, no allocation.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "libsim/base/decaying_exp.hpp"

namespace modcal {

/// Friction force of a sliding law at one speed.
struct SlidingPoint {
  double force;      ///< magnitude [N]
  double slope;      ///< d force/du [N s/m]
  double curvature;  ///< d² force/du² [N s²/m²]
};

/// Exponential Coulomb law: magnitude F_D + (F_S − F_D) exp(−C u) of the sliding force at the
/// sliding speed u = |v_c| (Debut, Delaune and Antunes, 2010, eq. 7, times F_N).
struct ExponentialSliding {
  double dynamic_force = 0.0;  ///< F_D = μ_D F_N [N]
  double force_drop = 0.0;     ///< F_S − F_D = (μ_S − μ_D) F_N [N]
  double decay = 0.0;          ///< C [s/m]

  using Point = SlidingPoint;
  Point at(double speed) const {
    const double excess = force_drop * decaying_exp(-decay * speed);
    return {dynamic_force + excess, -decay * excess, decay * decay * excess};
  }
  /// Steepest fall of the force with speed, max_u −d force/du [N s/m].
  double steepest_fall() const { return decay * force_drop; }

  class ClosedForm;
};

/// The force that the string feels, f = −side·g(u), at the root u of u + b g(u) = side·slip, b ≥ 0,
/// for side·slip ≥ b g(0).
///
/// With s = C b (F_S − F_D) exp(−C (side·slip − b F_D)) the force above F_D is T(s)/(C b), T the
/// tree function, T e^{−T} = s (Corless et al., 1996: T(s) = −W(−s)), here by its series
/// Σ n^{n−1}/n! sⁿ of 16 terms. It is used where C b (F_S − F_D) ≤ 0.05: s ≤ 0.05 e^{−0.05}, where
/// the rest of the series is 1.1e-16 of the sum.
class ExponentialSliding::ClosedForm {
 public:
  ClosedForm() = default;
  ClosedForm(const ExponentialSliding& law, double response)
      : dynamic_force_(law.dynamic_force),
        force_drop_(law.force_drop),
        decay_(law.decay),
        scale_(law.decay * law.force_drop * response),
        shift_(law.decay * law.dynamic_force * response) {
    // c_n = (n + 1)^n/(n + 1)!: 1, 1, 3/2, 8/3, …
    for (int n = 0; n < 16; ++n) {
      double term = 1.0;
      for (int k = 1; k <= n; ++k) term *= scale_ * (n + 1) / (k + 1);
      term_[n] = term;
    }
  }

  bool valid() const { return scale_ <= 0.05; }
  /// For slip = `slip0` + side·`response`·`older`, `older` being known last.
  double force(double side, double slip0, double response, double older) const {
    const double known = shift_ - (decay_ * side) * slip0;
    const double exponential = decaying_exp(known - (decay_ * response) * older);
    return (-side * force_drop_) * exponential * series(exponential) - side * dynamic_force_;
  }

 private:
  // T(s)/s as a function of s/(C b (F_S − F_D)).
  double series(double e) const {
    const double e2 = e * e, e4 = e2 * e2;
    const auto four = [&](int n) {
      return (term_[n] + e * term_[n + 1]) + e2 * (term_[n + 2] + e * term_[n + 3]);
    };
    return (four(0) + e4 * four(4)) + (e4 * e4) * (four(8) + e4 * four(12));
  }

  double dynamic_force_ = 0.0, force_drop_ = 0.0, decay_ = 0.0, scale_ = 0.0, shift_ = 0.0;
  double term_[16] = {};
};

/// Hyperbolic Coulomb law: magnitude F_D + (F_S − F_D)/(1 + u/v₀) of the sliding force at the
/// sliding speed u = |v_c| (McIntyre, Schumacher and Woodhouse, 1983).
struct HyperbolicSliding {
  double dynamic_force = 0.0;  ///< F_D = μ_D F_N [N]
  double force_drop = 0.0;     ///< F_S − F_D = (μ_S − μ_D) F_N [N]
  double half_speed = 1.0;     ///< v₀ [m/s]

  using Point = SlidingPoint;
  Point at(double speed) const {
    const double inverse = 1.0 / (half_speed + speed);
    const double excess = force_drop * half_speed * inverse;
    const double fall = excess * inverse;
    return {dynamic_force + excess, -fall, 2.0 * fall * inverse};
  }
  /// Steepest fall of the force with speed, max_u −d force/du [N s/m].
  double steepest_fall() const { return force_drop / half_speed; }
};

/// Every law that the step loop is compiled for. All are proportional to the normal force: the law
/// for F_N = 1 N is the friction coefficient μ(u), and F_N(t) μ(u) the force under a gesture.
using SlidingLaw = std::variant<ExponentialSliding, HyperbolicSliding>;

/// Magnitude of the sliding force [N] at the speed u ≥ 0 [m/s].
inline double sliding_force(const SlidingLaw& law, double speed) {
  return std::visit([speed](const auto& curve) { return curve.at(speed).force; }, law);
}

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
