#include "experiments/kinds/simulate_experiment.hpp"

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
  std::vector<std::string> lines =
      plan_scene(options_.truth.scene, options_.measurement.sample_rate, 1);
  for (const char* output : {"y", "v", "f_c", "R1", "R2"}) {
    const auto& wanted = options_.outputs;
    if (std::find(wanted.begin(), wanted.end(), output) != wanted.end()) continue;
    lines.push_back(fmt::format("skipped: {}, which nobody reads", output));
  }
  return lines;
}

}  // namespace modcal
