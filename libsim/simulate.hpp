// Simulation of a bowed or plucked string.
#pragma once

#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/scene.hpp"

namespace modcal {

/// How a scene is simulated and what is kept of it.
struct SimulationOptions {
  /// modal_event, modal_exact or newmark_explicit with its options.
  Choice<Simulator> simulator{"modal_event"};
  double sample_rate = 51200.0;  ///< of the record [Hz]
  OutputRequest outputs = OutputRequest::all();
};

/// Simulates the scene and samples the asked-for outputs: displacement [m], velocity [m/s] and
/// force [N] of the contact, reactions [N] of the ends. A simulation that cannot go on says when
/// and why in the result. Throws InvalidInput for a scene that cannot be simulated.
inline Simulation simulate(const Scene& scene, const SimulationOptions& options = {}) {
  return options.simulator.make()->simulate(scene, options.sample_rate, options.outputs);
}

}  // namespace modcal
