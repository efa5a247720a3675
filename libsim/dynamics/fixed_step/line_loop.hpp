// General fixed-step loop: several contact points, a bow of any motion, friction with a state. What
// the steady point contact needs is in step_loop.hpp, which stays as fast as that case allows.
//
// One step is Z_{k+1} = r Z_k + Σ_j (φ_j/m)(d₀ f_j,old + d₁ f_j,new) as there, with the forces of
// all points solved for together (implicit) or known (explicit).
#pragma once

#include <string>

#include "libsim/dynamics/gestures/bow.hpp"
#include "libsim/dynamics/fixed_step/line_modes.hpp"
#include "libsim/dynamics/fixed_step/step_loop.hpp"

namespace modcal {

/// A friction law as the points take it: a coefficient μ(u), or a law with a state.
struct LineFriction {
  SlidingLaw coefficient;  ///< for F_N = 1 N
  StatefulLaw stateful;    ///< used where it is not std::monostate
  double stiffness = 0.0;  ///< K_a of the whole contact [N/m]
  double damping = 0.0;    ///< C_a of the whole contact [N s/m]
};

struct LineLoop {
  ForceTiming timing = ForceTiming::kImplicit;
  double time_step = 0.0;
  std::size_t steps_per_sample = 1;
  std::size_t samples = 0;
  BowMotion bow;
  LineFriction friction;
  /// Displacement and velocity are the means over the points, the force is their sum.
  SampleTargets targets;
  /// Displacement, velocity and force of every contact point; empty: not asked for.
  std::vector<SampleTargets> point_targets;
  SwitchList switches;
  StopToken stop;  ///< polled between samples
};

struct LineCounts {
  std::uint64_t attachments = 0;
  std::uint64_t releases = 0;
  /// First sample at which the state is not finite or the forces of the points do not settle;
  /// SIZE_MAX: none.
  std::size_t first_bad_sample = static_cast<std::size_t>(-1);
  bool settled = true;  ///< false: the forces of several points did not settle
};

/// Runs all steps, sample 0 included.
LineCounts run_line_loop(const LineLoop& loop, const LineModes& modes,
                         const SchemeWeights& weights);

/// Largest response of the velocity of a point to the newest force, shared by the points alike or
/// with any signs [m/(N s)]: no pattern of the points answers more.
double contact_response(const LineModes& modes, const SchemeWeights& weights);

/// Largest fall of the friction force of the whole contact with the speed [N s/m]; 0 for a law with
/// a state, whose force does not follow the speed at once.
double steepest_fall(const LineLoop& loop);

}  // namespace modcal
