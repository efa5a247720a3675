// Nonlinear observer of the bowed string: simulates string and friction law and is corrected by the
// measured reactions at every sample. Kernel: no allocation, no I/O, no virtual call; instruction
// set chosen at run time.
//
// At sample k: ν = z_k − b − G Z, Z += K ν (the elongation of the adherence spring stays), the
// force is found again, and `coarse` steps of the exact propagator with first-order hold and the
// implicit scalar friction equation lead to sample k + 1. A step in which the string attaches or is
// released is taken again in `fine` ones; the jump of the force at an attachment is put at the
// linear crossing inside the fine step.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "libinverse/observer/string_tables.hpp"
#include "libsim/base/decaying_exp.hpp"

namespace modcal::observer {

/// Sliding law of the observer, a family wide enough for laws it was not told: magnitude of the
/// sliding force at the sliding speed u ≥ 0 [m/s], g(u) = F_D + ΔF [w e^{−Cu} + (1 − w) e^{−rCu}] +
/// s u [N]; w = 1, s = 0 is the exponential Coulomb law (Debut, Delaune and Antunes, 2010, eq. 7,
/// times F_N). `hyperbolic`: F_D + ΔF/(1 + Cu). `thermal`: the force follows the contact's
/// temperature T, in units of that at which rosin softens, g = F_D + ΔF/(1 + e^{(T − 1)/ω}), T' = a
/// |f| u − (b + c u) T (libsim/dynamics/friction/thermal.hpp, T = ϑ/ϑ_s, a = 1/(H ϑ_s), b = G/H, c
/// = S/H, ω = w/ϑ_s).
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

/// Correction per innovation of each reaction, Z += K₁ ν₁ + K₂ ν₂ [m/(N s)].
using GainTable = std::array<PlanarVector, 2>;

/// Contact parameters that stay the same over the record.
struct ContactLaw {
  BlendedSliding sliding;
  double stiffness = 0.0;  ///< K_a [N/m]
  double damping = 0.0;    ///< C_a [N s/m]
  double offset[2] = {};   ///< b, static level lost by the sensors [N]
};

/// State between two samples.
struct ObserverState {
  PlanarVector modes;
  double elongation = 0.0;   ///< y_c of the adherence spring [m]
  double force = 0.0;        ///< f_c [N]
  double side = -1.0;        ///< sgn v_c while it slides
  double temperature = 0.0;  ///< T of a thermal law [1]
  bool sticking = false;

  /// At rest on a string at rest, the bow moving in the positive direction.
  static ObserverState at_rest(std::size_t size);
};

/// Arrays over the samples of the whole record; null outputs are not written.
struct ObserverSignals {
  std::array<const double*, 2> reaction = {};  ///< z [N]
  const double* force_scale = nullptr;         ///< F_N(t) over its mean [1]
  const double* bow_velocity = nullptr;        ///< v_bow(t) [m/s]
  std::array<double*, 2> innovation = {};      ///< ν [N]
  double* force = nullptr;                     ///< f_c [N]
  double* velocity = nullptr;                  ///< v(x_c) [m/s]
  double* displacement = nullptr;              ///< y(x_c) [m]
  double* mean_force = nullptr;                ///< mean of f_c from this sample to the next [N]
};

/// Runs samples [first, last): corrected at each, then taken on to the next. On return `state` is
/// the prediction for sample `last`.
void run_observer(const StringTables& string, const ContactLaw& contact, const GainTable& gain,
                  const ObserverSignals& signals, std::size_t first, std::size_t last,
                  ObserverState& state);

}  // namespace modcal::observer
