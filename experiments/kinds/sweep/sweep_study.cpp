#include "experiments/kinds/sweep/sweep_study.hpp"

namespace modcal {
namespace {

// A score is a list of four in the store.
void visit_score(ResultVisitor& visitor, std::string_view key, WindowScore& score) {
  std::array values = {score.start, score.correlation, score.relative_rms_error,
                       score.anti_aliased};
  visitor({.key = key}, values);
  score = {values[0], values[1], values[2], values[3]};
}

}  // namespace

void TaskScores::visit(ResultVisitor& visitor) {
  visitor({.key = "side"}, side);
  visitor({.key = "parameter"}, parameter);
  visitor.word({.key = "status"}, status, ChoiceStatus::kNotReached);
  visitor.rows({.key = "scores"}, scores,
               [](ResultVisitor& item, WindowScore& score) { visit_score(item, {}, score); });
  visit_score(visitor, "whole", whole);
  visitor({.key = "misfit"}, misfit);
  visitor({.key = "warnings"}, warnings);
}

void TaskOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (failure.empty()) visitor({.key = "sides"}, sides);
}

TaskOutcome run_cell(const InvertOptions& options, const StudyContext& context) {
  const StreamKey key = options.key();
  const Observation observation = observe(options.observation, {.force = true}, context.work.truths,
                                          key, context.folder, options.score.oversampling);
  const AssumedModel model = with_errors(observation.basis, observation.contact,
                                         options.model_error, key.with("model error"));
  const InversionRecipe recipe(options.inversion);
  const auto estimator = context.work.inversions.get(model, observation, options.inversion, recipe);
  TaskOutcome outcome;
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
  return outcome;
}

void ComparisonOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "table",
                .meaning = "published figures: CSV with noise_percent, R1, epsilon1, R2, epsilon2",
                .required = true},
               table);
  visitor.number({.key = "lowest_row",
                  .meaning = "rows below this noise level are shown but not judged",
                  .unit = "1",
                  .range = Range::non_negative()},
                 lowest_row);
  visitor.number({.key = "mean_difference",
                  .meaning = "largest accepted mean |R_median - published R|; any: not judged",
                  .range = Range::non_negative(),
                  .word = "any"},
                 mean_difference);
  visitor.integer({.key = "inside_band",
                   .meaning = "least number of cells whose published R lies in the 10-90 % band",
                   .range = Range::non_negative()},
                  inside_band);
  visitor.number({.key = "parameter_factor",
                  .meaning = "factor within which the parameter agrees with the published one",
                  .range = Range::at_least(1.0)},
                 parameter_factor);
  visitor.integer({.key = "parameter_cells",
                   .meaning = "least number of cells whose parameter agrees",
                   .range = Range::non_negative()},
                  parameter_cells);
}

void SweepTarget::visit(OptionVisitor& visitor) {
  visitor.text({.key = "side",
                .meaning = "row of the table: 1, 2, or the estimator's name for its estimate",
                .required = true},
               side);
  visitor.number({.key = "noise",
                  .meaning = "row of the table: noise level",
                  .range = Range::non_negative(),
                  .required = true},
                 noise);
  visitor.number({.key = "correlation",
                  .meaning = "least mean correlation over windows and draws",
                  .range = Range::closed(-1.0, 1.0)},
                 correlation);
  visitor.number({.key = "whole",
                  .meaning = "least mean correlation over the long window",
                  .range = Range::closed(-1.0, 1.0)},
                 whole);
}

void SweepOptions::visit(OptionVisitor& visitor) {
  visitor.group({.key = "table", .meaning = "how the results are summed up"},
                [this](OptionVisitor& members) {
                  members.text({.key = "name", .meaning = "name of the table's files"}, name);
                });
  visitor.optional_group(
      {.key = "compare_with", .meaning = "published figures to hold beside ours"}, has_comparison,
      [this](OptionVisitor& members) { comparison.visit(members); });
  ListOf<SweepTarget> list(targets);
  visitor.list({.key = "targets", .meaning = "figures that rows of the table have to reach"}, list);
}

}  // namespace modcal
