// What a simulation leaves out because its scene does not need it, and what it costs.
#pragma once

#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

/// Something that is not computed; no output changes by it beyond rounding.
struct Skip {
  std::string what;
  std::string reason;
  /// Processor time of a second of the record that it saves, measured with and without it on the
  /// first part of the record [s].
  double saved_seconds = 0.0;
  std::string note;  ///< what the saving was counted or measured on
};

/// A simulation as the simulator will do it: read off a simulated first part of its record.
struct SimulationPlan {
  std::size_t modes = 0;
  std::size_t modes_moved = 0;
  std::size_t samples = 0;
  double time_step = 0.0;           ///< [s]
  double steps_per_second = 0.0;    ///< of the record [1/s]
  double set_up_seconds = 0.0;      ///< processor time before the first step [s]
  double seconds_per_second = 0.0;  ///< processor time of a second of the record [s]
  double piece = 0.0;               ///< length of the part that was simulated [s]
  std::vector<Skip> skips;

  /// Processor time of a record of this length [s].
  double seconds(double duration) const { return set_up_seconds + seconds_per_second * duration; }
};

/// Plans a simulation; takes about `budget` [s] of processor time. Throws InvalidInput where the
/// scene cannot be simulated.
SimulationPlan plan_simulation(const Scene& scene, const Simulator& simulator, double sample_rate,
                               const OutputRequest& outputs, double budget = 0.2);

/// The scene with every mode that rests at a node of the contact moving at 1e-200 m/s: it is
/// carried along then, and moves nothing.
Scene with_nodes_carried(Scene scene);

}  // namespace modcal
