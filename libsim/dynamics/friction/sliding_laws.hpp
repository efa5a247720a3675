// Sliding friction laws as plain values for the step loop: no virtual call, no allocation.
#pragma once

#include <variant>

#include "libsim/base/decaying_exp.hpp"

namespace modcal {

/// Exponential Coulomb law: magnitude F_D + (F_S − F_D) exp(−C u) of the sliding force at the
/// sliding speed u = |v_c| (Debut, Delaune and Antunes, 2010, eq. 7, times F_N).
struct ExponentialSliding {
  double dynamic_force = 0.0;  ///< F_D = μ_D F_N [N]
  double force_drop = 0.0;     ///< F_S − F_D = (μ_S − μ_D) F_N [N]
  double decay = 0.0;          ///< C [s/m]

  struct Point {
    double force;      ///< magnitude [N]
    double slope;      ///< d force/du [N s/m]
    double curvature;  ///< d² force/du² [N s²/m²]
  };
  Point at(double speed) const {
    const double excess = force_drop * decaying_exp(-decay * speed);
    return {dynamic_force + excess, -decay * excess, decay * decay * excess};
  }
  /// Steepest fall of the force with speed, max_u −d force/du [N s/m].
  double steepest_fall() const { return decay * force_drop; }
};

/// Every law that the step loop is compiled for.
using SlidingLaw = std::variant<ExponentialSliding>;

}  // namespace modcal
