// Simulation of a bowed string in modal form.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/base/registry.hpp"
#include "libsim/base/stop_token.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/dynamics/scene/switch.hpp"
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

/// Why a simulator cannot simulate a scene.
struct SceneRefusal {
  std::string key;     ///< of the scene's options, as "bow.points"
  std::string reason;  ///< value, reason and remedy
};

class Simulator {
 public:
  static constexpr std::string_view kKind = "simulator";
  static Registry<Simulator> registry();

  virtual ~Simulator() = default;
  /// Simulates the scene and samples the asked-for outputs at `sample_rate` [Hz]. Throws
  /// InvalidInput for a scene that cannot be simulated, Interrupted where `stop` was requested.
  Simulation simulate(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                      const StopToken& stop = {}) const;
  /// What of the scene this simulator cannot simulate, whatever the numbers; simulate() throws
  /// InvalidInput then.
  std::vector<SceneRefusal> refusals(const Scene& scene) const { return unsupported(scene); }

 private:
  virtual std::vector<SceneRefusal> unsupported(const Scene& /*scene*/) const { return {}; }
  /// May end early, with any result, once `stop` is requested.
  virtual Simulation run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                         const StopToken& stop) const = 0;
};

}  // namespace modcal
