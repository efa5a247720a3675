// The record that a simulator makes, and how it is written sample by sample.
#pragma once

#include <limits>
#include <optional>

#include "libsim/signal/signal.hpp"

namespace modcal {

/// What is computed and kept: nothing else is.
struct OutputRequest {
  bool displacement = false;    ///< y(x_c) [m]
  bool velocity = false;        ///< v(x_c) [m/s]
  bool force = false;           ///< f_c [N]
  bool left_reaction = false;   ///< R₁ at x = 0 [N]
  bool right_reaction = false;  ///< R₂ at x = L [N]
  /// Time from which the switches are listed [s]; infinite: none.
  double switches_from = std::numeric_limits<double>::infinity();

  static OutputRequest all() {
    return {.displacement = true,
            .velocity = true,
            .force = true,
            .left_reaction = true,
            .right_reaction = true};
  }
};

/// A change between sliding and sticking.
struct Switch {
  double time = 0.0;          ///< [s]
  double displacement = 0.0;  ///< y(x_c) there [m]
  bool attaches = false;      ///< from sliding to sticking
};

/// Takes the switches from a time on; by default none.
struct SwitchList {
  std::vector<Switch>* switches = nullptr;
  double from = std::numeric_limits<double>::infinity();  ///< [s]

  void add(const Switch& change) const {
    if (change.time >= from && switches != nullptr) switches->push_back(change);
  }
};

/// Sampled result. A signal that was not asked for has no samples.
struct Simulation {
  Signal displacement;
  Signal velocity;
  Signal force;
  Signal left_reaction;
  Signal right_reaction;

  double time_step = 0.0;       ///< the step taken [s]: divides the sampling period
  std::size_t steps = 0;        ///< steps taken
  std::size_t attachments = 0;  ///< changes from sliding to sticking
  std::size_t releases = 0;     ///< changes from sticking to sliding
  /// Steps that the simulator took back for shorter ones because its own checks did not hold.
  std::size_t refined_steps = 0;
  std::size_t modes_moved = 0;   ///< modes that the contact force reaches
  std::vector<Switch> switches;  ///< in the order of time, from OutputRequest::switches_from on
  /// Time at which the simulation could not go on [s]; such a result holds no signals.
  std::optional<double> diverged_at;
  /// Why it could not; empty otherwise.
  std::string explanation;

  /// Drops the signals of a simulation that could not go on.
  void diverge(double time, std::string reason);
};

/// What the contact and the ends of the string do at one instant.
struct MotionSample {
  double displacement = 0.0;  ///< y(x_c) [m]
  double velocity = 0.0;      ///< v(x_c) [m/s]
  double force = 0.0;         ///< f_c [N]
  double left = 0.0;          ///< R₁ [N]
  double right = 0.0;         ///< R₂ [N]
};

/// What of a motion is needed beside the force.
struct MotionRequest {
  bool contact = true;
  bool reactions = true;
};

/// Where the samples go; null: not asked for.
struct SampleTargets {
  double* displacement = nullptr;
  double* velocity = nullptr;
  double* force = nullptr;
  double* left_reaction = nullptr;
  double* right_reaction = nullptr;

  MotionRequest wanted() const {
    return {.contact = displacement || velocity, .reactions = left_reaction || right_reaction};
  }
  void write(std::size_t sample, const MotionSample& motion) const {
    if (displacement) displacement[sample] = motion.displacement;
    if (velocity) velocity[sample] = motion.velocity;
    if (force) force[sample] = motion.force;
    if (left_reaction) left_reaction[sample] = motion.left;
    if (right_reaction) right_reaction[sample] = motion.right;
  }
};

/// Number of samples of a record: duration·f_s rounded to the nearest, at t = 0, 1/f_s, …
/// Throws InvalidInput where that is no positive number up to 2³¹.
std::size_t sample_count(double duration, double sample_rate);

/// Largest time step ≤ the wanted one that divides the sampling period a whole number of times.
struct StepPlan {
  double time_step = 0.0;            ///< [s]
  std::size_t steps_per_sample = 0;  ///< m, f_s·m·Δt = 1
};
StepPlan plan_steps(double wanted_time_step, double sample_rate);

/// A result whose asked-for signals have `count` zeros.
Simulation empty_simulation(std::size_t count, double rate, const OutputRequest& outputs);

/// Where the samples of its signals are.
SampleTargets targets_of(Simulation& result);

}  // namespace modcal
