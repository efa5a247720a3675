#include "experiments/kinds/identify_experiment.hpp"

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/scene_plan.hpp"

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
  std::vector<std::string> lines =
      plan_scene(options_.truth.scene, options_.measurement.sample_rate, 1);
  lines.push_back(fmt::format("identify modes up to {:g} Hz by {}, orders {} to {}",
                              options_.identification.highest_frequency,
                              options_.identification.method,
                              options_.identification.stabilization.lowest_order,
                              options_.identification.stabilization.highest_order));
  return lines;
}

}  // namespace modcal
