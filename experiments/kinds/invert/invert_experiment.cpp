#include "experiments/kinds/invert/invert_experiment.hpp"

#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/scene_plan.hpp"

namespace modcal {

std::vector<Finding> lint_inversion(const InvertOptions& options) {
  std::vector<Finding> findings = lint_observation(options.observation);
  lint_making(
      "inversion", [&] { InversionRecipe recipe(options.inversion); }, findings);
  append(findings, lint_scores(options.score, options.observation));
  if (findings.empty() && is_known(options.observation.string_model())) {
    lint_making(
        "model_error",
        [&] {
          with_errors(make_modal_basis(options.observation.string_model()),
                      options.observation.contact_point(), options.model_error,
                      options.key().with("model error"));
        },
        findings);
  }
  return findings;
}

std::vector<Finding> InvertExperiment::lint() const {
  std::vector<Finding> findings = lint_inversion(options_);
  append(findings, lint_figures(options_.figures, {"waveforms", "spectra", "parameter_curves"}));
  for (const FigureOptions& figure : options_.figures) {
    for (const std::string& quantity : figure.quantities) {
      if (quantity != "R1" && quantity != "R2") continue;
      findings.push_back({"figures", fmt::format("figure {} draws {}, which is measured, not "
                                                 "identified: use y, v or f_c",
                                                 figure.id, quantity)});
    }
  }
  return findings;
}

std::vector<std::string> InvertExperiment::plan() const {
  std::vector<std::string> lines;
  const auto planned = planned_simulations();
  lines.push_back(planned ? plan_line(*planned) : "record: " + options_.observation.record.file);
  const InversionOutputs outputs = inversion_outputs(options_.figures, options_.write_signals);
  if (!outputs.displacement)
    lines.push_back("skipped: identified displacement, which nobody reads");
  if (!outputs.velocity) lines.push_back("skipped: identified velocity, which nobody reads");
  return lines;
}

std::optional<PlannedSimulations> InvertExperiment::planned_simulations() const {
  return planned_truths(options_.observation, truth_outputs(options_.figures));
}

}  // namespace modcal
