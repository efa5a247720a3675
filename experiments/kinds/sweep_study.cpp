#include "experiments/kinds/sweep_study.hpp"

#include "libsim/base/error.hpp"

namespace modcal {
TaskOutcome run_cell(const SweepCell& cell, const StudyContext& context) {
  const InvertOptions& options = cell.options;
  const StreamKey key = options.key();
  TaskOutcome outcome;
  try {
    const Observation observation =
        observe(options.observation, {.force = true}, context.work.truths, key, context.folder);
    const AssumedModel model = with_errors(observation.basis, observation.contact,
                                           options.model_error, key.with("model error"));
    const auto inversions =
        context.work.inversions.get(model, observation.samples(), observation.sample_rate);
    const InversionRecipe recipe(options.inversion);
    for (const SideIdentification& side :
         identify(observation, *inversions, recipe, {.force = true}, &options.score)) {
      outcome.sides.push_back(
          {side.end, side.result.choice.parameter(), side.result.choice.status, side.scores});
    }
  } catch (const InvalidInput& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

}  // namespace modcal
