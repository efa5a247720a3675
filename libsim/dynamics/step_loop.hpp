// Fixed-step loop shared by the time-stepping simulators. Kernel: no allocation, no I/O, no virtual
// call; instruction set chosen at run time.
//
// One step of either scheme is Z_{k+1} = r Z_k + … with forces of the two ends. With
// S = the part of Z that does not need the newest force u's partner,
//   S_{k+1} = r S_k + D u,      Z_{k+1} = S_{k+1} + d f,
// the sums over the modes that the contact needs are those of P_k = r S_k plus a scalar times u:
// they do not wait for the force of the running step, which hides the latency of the reduction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libsim/base/aligned_vector.hpp"
#include "libsim/base/stop_token.hpp"
#include "libsim/dynamics/contact_modes.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"
#include "libsim/dynamics/switch.hpp"

namespace modcal {

/// When the force of a step is known to the step that it drives.
enum class ForceTiming {
  kPreviousStep,  ///< explicit: the force of the previous step drives this one (the paper)
  kImplicit,      ///< the force at the end of the step is solved for together with the velocity
};

/// One-step coefficients of every mode in the coordinates (v, y) = (φ q̇, φ q), its shares of the
/// velocity and displacement of the contact, whose sums over the modes are plain: padded with
/// zeros to whole vectors.
struct StepCoefficients {
  AlignedVector vv, vy, yv, yy;  ///< r as a matrix: v ← vv v + vy y, y ← yv v + yy y
  AlignedVector deferred_velocity, deferred_displacement;  ///< D [m/(N s)], [m/N]
  AlignedVector left_gain, right_gain;                     ///< g/φ [N/m]
  AlignedVector velocity, displacement;  ///< P [m/s], [m], overwritten by the loop
  // Σ over modes: response of velocity, displacement and reactions to D and to d.
  struct Response {
    double velocity = 0.0, displacement = 0.0, left = 0.0, right = 0.0;
  };
  Response deferred_response;
  Response direct_response;
};

/// Scheme given by r, d₀ (weight of the older force) and d₁ (weight of the newer force), per mode:
/// Z_{k+1} = r Z_k + drive·(d₀ f_old + d₁ f_new). `initial_force` is f_new of t = 0.
struct SchemeWeights {
  std::vector<std::complex<double>> propagate, older, newer;
};
StepCoefficients make_step_coefficients(const ContactModes& modes, const SchemeWeights& weights,
                                        double initial_force);

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
