// Fixed-step loop shared by the time-stepping simulators. Kernel: no allocation, no I/O, no virtual
// call; instruction set chosen at run time.
//
// The string runs ahead of the contact: what the modes answer to all forces but the last two is
// known two steps before it is needed, and these two come in by one product each. The sum over the
// modes, a long chain of dependent operations, therefore keeps no step waiting. And it is one sum,
// that of the quantity which decides the step: the slip velocity while the contact slides, the
// force of the adherence on the string while it sticks.
#pragma once

#include "libsim/base/task_loop.hpp"
#include "libsim/dynamics/fixed_step/step_coefficients.hpp"

namespace modcal {

/// When the force of a step is known to the step that it drives.
enum class ForceTiming {
  kPreviousStep,  ///< explicit: the force of the previous step drives this one (the paper)
  kImplicit,      ///< the force at the end of the step is solved for together with the velocity
};

/// The time grid of a run and where its results go.
struct FixedStepRun {
  ForceTiming timing = ForceTiming::kImplicit;
  double time_step = 0.0;  ///< [s]
  std::size_t steps_per_sample = 1;
  std::size_t samples = 0;
  /// Sample j is taken after j·steps_per_sample steps.
  SampleTargets targets;
  /// Displacement, velocity and force of every contact point; empty: not asked for.
  std::vector<SampleTargets> point_targets;
  SwitchList switches;
  StopToken stop;  ///< polled between samples
};

struct LoopCounts {
  std::uint64_t attachments = 0;
  std::uint64_t releases = 0;
  /// First sample at which the state is not finite or the forces of the points do not settle;
  /// SIZE_MAX: none.
  std::size_t first_bad_sample = static_cast<std::size_t>(-1);
  bool settled = true;  ///< false: the forces of several points did not settle
};

/// One contact point under a steady bow.
struct SteadyContact {
  ContactParameters parameters;
  SlidingLaw law;
  double initial_displacement = 0.0;  ///< y at t = 0 [m]
  double initial_velocity = 0.0;      ///< v at t = 0 [m/s]
};

/// Runs all steps. Sample 0, the state at t = 0, is the caller's.
LoopCounts run_step_loop(const FixedStepRun& run, const SteadyContact& contact,
                         StepCoefficients& coefficients);

/// Force of the contact at t = 0 [N].
double initial_force(const SteadyContact& contact);

/// The contact of any bow: `friction` and `parameters` belong to all points together, which share
/// them alike.
struct GeneralContact {
  ContactParameters parameters;
  const FrictionLaw& friction;
  const BowMotion& bow;
};

/// Runs all steps, sample 0 included. Displacement and velocity are the means over the points, the
/// force is their sum.
LoopCounts run_line_loop(const FixedStepRun& run, const GeneralContact& contact,
                         const LineModes& modes, const SchemeWeights& weights);

/// Largest response of the velocity of a point to the newest force, shared by the points alike or
/// with any signs [m/(N s)]: no pattern of the points answers more.
double contact_response(const LineModes& modes, const SchemeWeights& weights);

}  // namespace modcal
