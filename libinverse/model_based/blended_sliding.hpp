// Sliding law of the observer: a family wide enough for laws it was not told.
#pragma once

#include "libsim/base/decaying_exp.hpp"

namespace modcal::observer {

/// Magnitude of the sliding force at the sliding speed u ≥ 0 [m/s],
/// g(u) = F_D + ΔF [w e^{−Cu} + (1 − w) e^{−rCu}] + s u [N]; w = 1, s = 0 is the exponential
/// Coulomb law (Debut, Delaune and Antunes, 2010, eq. 7, times F_N).
struct BlendedSliding {
  double dynamic_force = 0.0;  ///< F_D [N]
  double force_drop = 0.0;     ///< ΔF = F_S − F_D [N]
  double decay = 0.0;          ///< C [s/m]
  double weight = 1.0;         ///< w [1]
  double ratio = 1.0;          ///< r [1]
  double viscous = 0.0;        ///< s [N s/m]
  bool hyperbolic = false;

  struct Point {
    double force;  ///< [N]
    double slope;  ///< [N s/m]
  };
  Point at(double speed) const {
    if (hyperbolic) {
      const double inverse = 1.0 / (1.0 + decay * speed);
      const double excess = force_drop * inverse;
      return {dynamic_force + excess, -decay * excess * inverse};
    }
    const double near = weight * force_drop * decaying_exp(-decay * speed);
    double force = dynamic_force + near;
    double slope = -decay * near;
    if (weight != 1.0) {
      const double far = (1.0 - weight) * force_drop * decaying_exp(-ratio * decay * speed);
      force += far;
      slope -= ratio * decay * far;
    }
    return {force + viscous * speed, slope + viscous};
  }
  /// Force at rest F_S [N].
  double at_rest() const { return dynamic_force + force_drop; }
};

}  // namespace modcal::observer
