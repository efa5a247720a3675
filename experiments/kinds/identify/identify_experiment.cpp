#include "experiments/kinds/identify/identify_experiment.hpp"

#include "experiments/kinds/lint.hpp"
#include "libinverse/modes/decay_length.hpp"

namespace modcal {

std::vector<Finding> IdentifyExperiment::lint() const {
  std::vector<Finding> findings =
      lint_scene(options_.truth.scene, options_.truth.simulator, options_.measurement);
  if (options_.truth.scene.start.selected() == "rest") {
    findings.push_back({"scene.initial", "a string at rest has no free decay: pluck it"});
  }
  const double rate = options_.measurement.sample_rate;
  if (!(options_.identification.highest_frequency < 0.5 * rate)) {
    findings.push_back({"identification.highest_frequency",
                        fmt::format("{:g} Hz lie above half the sample rate {:g} Hz",
                                    options_.identification.highest_frequency, rate)});
  } else if (findings.empty()) {
    lint_making(
        "scene.duration",
        [&] {
          require_decay_length(sample_count(options_.truth.scene.duration, rate), rate,
                               options_.identification);
        },
        findings);
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
