#include "experiments/kinds/scene_plan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace modcal {

namespace {

std::string counted(const PlannedSimulations& planned) {
  return fmt::format(
      "{} of {:g} s, {} samples at {:g} Hz each", planned.count, planned.scene.duration,
      sample_count(planned.scene.duration, planned.sample_rate), planned.sample_rate);
}

std::string key_of(const PlannedSimulations& planned) {
  return truth_key({planned.scene, planned.simulator}, planned.sample_rate, planned.outputs);
}

}  // namespace

std::string plan_line(const PlannedSimulations& planned) {
  std::string text = "simulations: " + counted(planned);
  for (const PlannedSimulations& other : planned.others) text += "; " + counted(other);
  return text;
}

void add_planned(const ObservationOptions& observation, PlannedSimulations& planned) {
  const auto other = planned_truths(observation, {});
  if (!other) return;
  const bool known =
      std::any_of(planned.others.begin(), planned.others.end(),
                  [&](const PlannedSimulations& one) { return key_of(one) == key_of(*other); });
  if (!known) planned.others.push_back(*other);
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
