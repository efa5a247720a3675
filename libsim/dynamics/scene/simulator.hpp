// Simulation of a bowed string in modal form.
#pragma once

#include <limits>

#include "libsim/base/task_loop.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/dynamics/scene/simulation.hpp"

namespace modcal {

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
  /// The longest step that it takes [s]; infinite where steps are no longer than they need be.
  double longest_step() const { return stated_step(); }

 private:
  virtual double stated_step() const { return std::numeric_limits<double>::infinity(); }
  virtual std::vector<SceneRefusal> unsupported(const Scene& /*scene*/) const { return {}; }
  /// May end early, with any result, once `stop` is requested.
  virtual Simulation run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                         const StopToken& stop) const = 0;
};

/// Scenes by their number, made when they are simulated, and what is computed of each.
struct Ensemble {
  std::size_t size = 0;
  std::function<Scene(std::size_t)> scene;  ///< called from any thread
  double sample_rate = 0.0;                 ///< [Hz]
  OutputRequest outputs;
};

/// Simulates every scene of an ensemble over threads (for_each_task) and hands each result over as
/// soon as it is there: take(i, simulation) is called once for every i, from any thread and in any
/// order. Only the records that are being computed are held, one a thread. A scene that diverges is
/// a result; one that cannot be simulated throws. Throws Interrupted where `stop` was requested,
/// also in the middle of a scene.
void simulate_ensemble(const Simulator& simulator, const Ensemble& ensemble,
                       const std::function<void(std::size_t, Simulation)>& take,
                       const StopToken& stop = {});

/// reduce(i, simulation) of every scene, in their order: the same bits for any number of threads.
template <typename Reduced>
std::vector<Reduced> reduce_ensemble(
    const Simulator& simulator, const Ensemble& ensemble,
    const std::function<Reduced(std::size_t, const Simulation&)>& reduce,
    const StopToken& stop = {}) {
  static_assert(!std::is_same_v<Reduced, bool>, "std::vector<bool> cannot be written by threads");
  std::vector<Reduced> results(ensemble.size);
  simulate_ensemble(
      simulator, ensemble,
      [&](std::size_t index, const Simulation& simulation) {
        results[index] = reduce(index, simulation);
      },
      stop);
  return results;
}

}  // namespace modcal
