// Sliding friction laws as plain values for the step loop: no virtual call, no allocation.
#pragma once

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

}  // namespace modcal
