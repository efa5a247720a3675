// What happens: string, bow, initial motion and duration. How it is computed is the simulator's
// business.
#pragma once

#include <cstdint>

#include "libsim/base/options.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/bow.hpp"
#include "libsim/dynamics/scene/initial_motion.hpp"
#include "libsim/model/modal_basis.hpp"
#include "libsim/model/string_model.hpp"

namespace modcal {

/// Torsional modes, coupled to the transverse ones by the contact force alone (Friedlander, 1953;
/// Serafin, Smith and Woodhouse, 1999): the friction force f turns the string by the torque a f,
/// and the friction law sees the velocity of the surface v + a θ'. In the surface displacement
/// a θ = Σ sin(nπx/L) τ_n,
///   m_T (τ_n'' + 2 ζ_T ω_n τ_n' + ω_n² τ_n) = sin(nπx_c/L) f_c,  ω_n = n π c_T/L,  m_T = μ_T L/2,
/// where μ_T = I/a² = Z_T/c_T [kg/m] is the moment of inertia per length seen at the surface: the
/// radius a drops out. Torsion exerts no force on the ends of the string.
struct Torsion {
  bool present = false;
  std::int64_t modes = 20;
  double speed_ratio = 5.0;      ///< c_T/c, torsional over transverse wave speed [1]
  double impedance_ratio = 2.0;  ///< Z_T/Z₀, Z₀ = ρ_L c [1]
  double damping_ratio = 1e-2;   ///< ζ_T [1]
  void visit(OptionVisitor& visitor);

  /// The torsional modes of a string in surface displacement; no tension: no reactions. Empty where
  /// not present.
  ModalBasis basis(const ModalBasis& transverse, double wave_speed) const;
};

struct Scene {
  StringModel string;
  Bow bow;
  Choice<FrictionLaw> friction{"coulomb_exponential"};
  double duration = 1.0;  ///< [s]
  Choice<InitialMotion> start{"rest"};
  Torsion torsion;
  /// Modal state set in code, in the place of `start`; empty: that of `start`.
  ModalState initial;
  void visit(OptionVisitor& visitor);
};

/// The modal state of the scene's string at t = 0.
ModalState initial_state(const Scene& scene, const ModalBasis& basis);

}  // namespace modcal
