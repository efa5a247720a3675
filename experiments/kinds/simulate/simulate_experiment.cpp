#include "experiments/kinds/simulate/simulate_experiment.hpp"

#include <algorithm>

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/scene_plan.hpp"

namespace modcal {

std::vector<Finding> SimulateExperiment::lint() const {
  std::vector<Finding> findings =
      lint_scene(options_.truth.scene, options_.truth.simulator, options_.measurement);
  append(findings, lint_figures(options_.figures, {"waveforms"}));
  for (const FigureOptions& figure : options_.figures) {
    for (const std::string& quantity : figure.quantities) {
      const auto& outputs = options_.outputs;
      if (std::find(outputs.begin(), outputs.end(), quantity) != outputs.end()) continue;
      findings.push_back(
          {"outputs",
           fmt::format("figure {} draws {}, which is not among the outputs", figure.id, quantity)});
    }
  }
  return findings;
}

std::vector<std::string> SimulateExperiment::plan() const {
  return {plan_line(*planned_simulations())};
}

std::optional<PlannedSimulations> SimulateExperiment::planned_simulations() const {
  return PlannedSimulations{.scene = options_.truth.scene,
                            .simulator = options_.truth.simulator,
                            .sample_rate = options_.measurement.sample_rate,
                            .outputs = request_of(options_.outputs)};
}

}  // namespace modcal
