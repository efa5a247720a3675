#include "libsim/dynamics/scene/ensemble.hpp"

#include "libsim/base/task_loop.hpp"

namespace modcal {

void simulate_ensemble(const Simulator& simulator, const Ensemble& ensemble,
                       const std::function<void(std::size_t, Simulation)>& take,
                       const StopToken& stop) {
  for_each_task(
      ensemble.size,
      [&](std::size_t index) {
        take(index, simulator.simulate(ensemble.scene(index), ensemble.sample_rate,
                                       ensemble.outputs, stop));
      },
      stop);
}

}  // namespace modcal
