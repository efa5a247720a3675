// Many scenes, one after another on every thread.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "libsim/base/stop_token.hpp"
#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

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
