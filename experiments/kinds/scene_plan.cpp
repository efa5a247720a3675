#include "experiments/kinds/scene_plan.hpp"

#include <fmt/format.h>

namespace modcal {

std::string plan_line(const PlannedSimulations& planned) {
  return fmt::format("simulations: {} of {:g} s, {} samples at {:g} Hz each", planned.count,
                     planned.scene.duration,
                     sample_count(planned.scene.duration, planned.sample_rate),
                     planned.sample_rate);
}

std::optional<PlannedSimulations> planned_truths(const ObservationOptions& observation,
                                                 OutputRequest outputs, std::size_t count) {
  if (!observation.has_scene) return std::nullopt;
  outputs.left_reaction = true;
  outputs.right_reaction = true;
  return PlannedSimulations{observation.truth.scene, observation.truth.simulator,
                            observation.measurement.sample_rate, outputs, count};
}

}  // namespace modcal
