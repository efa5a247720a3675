#include "experiments/kinds/kind_list.hpp"

#include "experiments/kinds/run_summary.hpp"

namespace modcal {

StudyResult sum_up_runs(const TaskExperiment& list, const TaskOutcomes& outcomes) {
  StudyResult result;
  RunSummary summary(list);
  for_each_outcome<RunOutcome>(outcomes, result,
                               [&](std::size_t task, RunOutcome outcome, double /*seconds*/) {
                                 summary.add(task, std::move(outcome));
                               });
  report::Table settings = summary.settings();
  result.answer = fmt::format("{} settings, medians over their draws", settings.rows.size());
  result.summary = fmt::format("{} of {} tasks done, {} failed; {} settings, see tasks.csv\n",
                               outcomes.size() - result.pending_tasks, outcomes.size(),
                               result.failed_tasks, settings.rows.size());
  warn_of(summary.warned(), result);
  report::Figure figure = summary.figure();
  if (!figure.panels.empty()) {
    result.blocks.emplace_back(std::move(figure));
  } else {
    result.add(summary.maps());
  }
  result.end_first_screen();
  result.blocks.emplace_back(std::move(settings));
  result.files.emplace_back("tasks.csv", summary.tasks_csv());
  return result;
}

}  // namespace modcal
