#include "experiments/kinds/identify_experiment.hpp"

#include "experiments/kinds/lint.hpp"

namespace modcal {

std::vector<Finding> IdentifyExperiment::lint() const {
  std::vector<Finding> findings =
      lint_scene(options_.truth.scene, options_.truth.simulator, options_.measurement);
  if (options_.truth.scene.start.selected() == "rest") {
    findings.push_back({"scene.initial", "a string at rest has no free decay: pluck it"});
  }
  if (!(options_.identification.highest_frequency < 0.5 * options_.measurement.sample_rate)) {
    findings.push_back(
        {"identification.highest_frequency",
         fmt::format("{:g} Hz lie above half the sample rate {:g} Hz",
                     options_.identification.highest_frequency, options_.measurement.sample_rate)});
  }
  if (!(options_.identification.skip < options_.truth.scene.duration)) {
    findings.push_back({"identification.skip", "the whole record is left out"});
  }
  return findings;
}

std::vector<std::string> IdentifyExperiment::plan() const {
  const PluckOptions& identification = options_.identification;
  return {fmt::format("identify modes up to {:g} Hz by {}, orders {} to {}",
                      identification.highest_frequency, identification.method,
                      identification.stabilization.lowest_order,
                      identification.stabilization.highest_order)};
}

std::optional<PlannedSimulations> IdentifyExperiment::planned_simulations() const {
  return PlannedSimulations{.scene = options_.truth.scene,
                            .simulator = options_.truth.simulator,
                            .sample_rate = options_.measurement.sample_rate,
                            .outputs = {.left_reaction = true, .right_reaction = true}};
}

}  // namespace modcal
