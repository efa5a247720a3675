// What a run would do, in lines and as data.
#include "experiments/kinds/lint.hpp"

namespace modcal {
namespace {

std::string counted(const PlannedSimulations& planned) {
  return fmt::format(
      "{} of {:g} s, {} samples at {:g} Hz each", planned.count, planned.truth.scene.duration,
      sample_count(planned.truth.scene.duration, planned.sample_rate), planned.sample_rate);
}

// The same for programs.
nlohmann::ordered_json counts_of(const PlannedSimulations& planned) {
  return {{"count", planned.count},
          {"duration", planned.truth.scene.duration},
          {"samples", sample_count(planned.truth.scene.duration, planned.sample_rate)},
          {"sample_rate", planned.sample_rate}};
}

}  // namespace

nlohmann::ordered_json facts_of(const std::vector<PlanLine>& lines) {
  auto all = nlohmann::ordered_json::object();
  for (const PlanLine& line : lines) {
    for (const auto& [name, value] : line.facts.items()) {
      nlohmann::ordered_json& known = all[name];
      if (known.is_array() && value.is_array()) {
        known.insert(known.end(), value.begin(), value.end());
      } else {
        known = value;
      }
    }
  }
  return all;
}

std::string key_of(const PlannedSimulations& planned) {
  return truth_key(planned.truth, planned.sample_rate, planned.outputs);
}

PlanLine plan_line(const PlannedSimulations& planned) {
  std::string text = "simulations: " + counted(planned);
  auto list = nlohmann::ordered_json::array({counts_of(planned)});
  for (const PlannedSimulations& other : planned.others) {
    text += "; " + counted(other);
    list.push_back(counts_of(other));
  }
  return {std::move(text), {{"simulations", std::move(list)}}};
}

PlanLine source_line(const std::optional<PlannedSimulations>& planned,
                     const ObservationOptions& observation) {
  if (planned) return plan_line(*planned);
  return {"record: " + observation.record.file, {{"record", observation.record.file}}};
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
  return PlannedSimulations{observation.truth, observation.measurement.sample_rate, outputs, count};
}

}  // namespace modcal
