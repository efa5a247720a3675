// Fixed-step loop shared by the time-stepping simulators. Kernel: no allocation, no I/O, no virtual
// call; instruction set chosen at run time.
//
// The string runs ahead of the contact: what the modes answer to all forces but the last two is
// known two steps before it is needed, and these two come in by one product each. The sum over the
// modes, a long chain of dependent operations, therefore keeps no step waiting. And it is one sum,
// that of the quantity which decides the step: the slip velocity while the contact slides, the
// force of the adherence on the string while it sticks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libsim/base/stop_token.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"
#include "libsim/dynamics/fixed_step/step_coefficients.hpp"
#include "libsim/dynamics/scene/switch.hpp"

namespace modcal {

/// When the force of a step is known to the step that it drives.
enum class ForceTiming {
  kPreviousStep,  ///< explicit: the force of the previous step drives this one (the paper)
  kImplicit,      ///< the force at the end of the step is solved for together with the velocity
};

struct ContactParameters {
  double bow_velocity = 0.0;  ///< [m/s]
  double static_limit = 0.0;  ///< μ_S F_N [N]
  double stiffness = 0.0;     ///< K_a [N/m]
  double damping = 0.0;       ///< C_a [N s/m]
};

/// Where the samples go; null: not asked for. Sample j is taken after j·steps_per_sample steps.
struct SampleTargets {
  double* displacement = nullptr;
  double* velocity = nullptr;
  double* force = nullptr;
  double* left_reaction = nullptr;
  double* right_reaction = nullptr;
};

struct LoopCounts {
  std::uint64_t attachments = 0;
  std::uint64_t releases = 0;
  /// First sample at which the state is not finite; SIZE_MAX: none.
  std::size_t first_bad_sample = static_cast<std::size_t>(-1);
};

struct StepLoop {
  ForceTiming timing = ForceTiming::kImplicit;
  double time_step = 0.0;
  std::size_t steps_per_sample = 1;
  std::size_t samples = 0;
  ContactParameters contact;
  SlidingLaw law;
  double initial_displacement = 0.0;  ///< y at t = 0 [m]
  double initial_velocity = 0.0;      ///< v at t = 0 [m/s]
  SampleTargets targets;
  SwitchList switches;
  StopToken stop;  ///< polled between samples
};

/// Runs all steps. Sample 0 is the state at t = 0.
LoopCounts run_step_loop(const StepLoop& loop, StepCoefficients& coefficients);

}  // namespace modcal
