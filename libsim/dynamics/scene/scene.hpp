// What happens: string, bow, initial motion and duration. How it is computed is the simulator's
// business.
#pragma once

#include "libsim/dynamics/gestures/bow.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/scene/initial_motion.hpp"
#include "libsim/dynamics/scene/torsion.hpp"
#include "libsim/model/string_model.hpp"

namespace modcal {

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
