#include "experiments/kinds/sweep/sweep_study.hpp"

#include "libsim/base/error.hpp"

namespace modcal {
TaskOutcome run_cell(const SweepCell& cell, const StudyContext& context) {
  const InvertOptions& options = cell.options;
  const StreamKey key = options.key();
  TaskOutcome outcome;
  try {
    const Observation observation =
        observe(options.observation, {.force = true}, context.work.truths, key, context.folder,
                options.score.oversampling);
    const AssumedModel model = with_errors(observation.basis, observation.contact,
                                           options.model_error, key.with("model error"));
    const InversionRecipe recipe(options.inversion);
    const auto estimator =
        context.work.inversions.get(model, observation, options.inversion, recipe);
    for (const SideIdentification& side :
         identify(observation, *estimator, recipe, {.force = true}, &options.score)) {
      const ChosenParameter& choice = side.estimate.result.choice;
      TaskScores scores{side.estimate.side, choice.parameter(), choice.status, side.scores,
                        side.whole};
      for (const auto& [name, value] : side.estimate.figures) {
        if (name == "misfit") scores.misfit = value;
      }
      scores.warnings = side.estimate.warnings;
      outcome.sides.push_back(std::move(scores));
    }
  } catch (const InvalidInput& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

}  // namespace modcal
