// Sliding law of the observer: a family wide enough for laws it was not told.
#pragma once

#include <cmath>

#include "libsim/base/decaying_exp.hpp"

namespace modcal::observer {

/// Magnitude of the sliding force at the sliding speed u ≥ 0 [m/s],
/// g(u) = F_D + ΔF [w e^{−Cu} + (1 − w) e^{−rCu}] + s u [N]; w = 1, s = 0 is the exponential
/// Coulomb law (Debut, Delaune and Antunes, 2010, eq. 7, times F_N). `hyperbolic`: F_D + ΔF/(1 +
/// Cu). `thermal`: the force follows the contact's temperature T, in units of that at which rosin
/// softens, g = F_D + ΔF/(1 + e^{(T − 1)/ω}), T' = a |f| u − (b + c u) T
/// (libsim/dynamics/friction/thermal.hpp, T = ϑ/ϑ_s, a = 1/(H ϑ_s), b = G/H, c = S/H, ω = w/ϑ_s).
struct BlendedSliding {
  double dynamic_force = 0.0;  ///< F_D [N]
  double force_drop = 0.0;     ///< ΔF = F_S − F_D [N]
  double decay = 0.0;          ///< C [s/m]
  double weight = 1.0;         ///< w [1]
  double ratio = 1.0;          ///< r [1]
  double viscous = 0.0;        ///< s [N s/m]
  bool hyperbolic = false;
  bool thermal = false;
  double heating = 0.0;      ///< a [1/J]
  double cooling = 0.0;      ///< b [1/s]
  double carried = 0.0;      ///< c [1/m]
  double width = 1.0;        ///< ω [1]
  double temperature = 0.0;  ///< T [1], a state

  struct Point {
    double force;  ///< [N]
    double slope;  ///< [N s/m]
  };
  Point at(double speed) const {
    if (thermal) return {at_rest(), 0.0};
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
  /// Force at rest F_S [N]; thermal: at the present temperature.
  double at_rest() const {
    const double share = thermal ? 1.0 / (1.0 + std::exp((temperature - 1.0) / width)) : 1.0;
    return dynamic_force + share * force_drop;
  }
  /// Takes T on by h [s] at the sliding speed u ≥ 0 [m/s] under the force |f| [N], backward Euler.
  void warm(double h, double speed, double force) {
    temperature =
        (temperature + h * heating * force * speed) / (1.0 + h * (cooling + carried * speed));
  }
};

}  // namespace modcal::observer
