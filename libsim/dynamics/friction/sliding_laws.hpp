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
