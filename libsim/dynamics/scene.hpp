// What happens: string, bow and duration. How it is computed is the simulator's business.
#pragma once

#include <limits>
#include <vector>

#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/model/string_model.hpp"

namespace modcal {

/// Steady bow stroke: contact point x_c [m], bow velocity v_bow [m/s], normal force F_N [N].
struct Bow {
  double position = std::numeric_limits<double>::quiet_NaN();
  double velocity = 0.1;
  double normal_force = 1.0;
  void visit(OptionVisitor& visitor);
};

/// Modal displacements q_n [m] and velocities q̇_n [m/s] at t = 0; empty: at rest.
struct ModalState {
  std::vector<double> displacement;
  std::vector<double> velocity;
};

struct Scene {
  StringModel string;
  Bow bow;
  Choice<FrictionLaw> friction{"coulomb_exponential"};
  double duration = 1.0;  ///< [s]
  ModalState initial;
  void visit(OptionVisitor& visitor);
};

}  // namespace modcal
