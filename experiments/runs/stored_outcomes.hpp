// Outcomes of one type in the store. Such a type has the member `failure`, why there is nothing
// else in it (empty: there is), and a visit(ResultVisitor&) that describes it.
#pragma once

#include <string>
#include <utility>

#include "experiments/report/result_json.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal {

/// Throws InvalidInput for a text that report::json_line() of such an outcome did not write.
template <typename Outcome>
Outcome read_outcome(const std::string& text) {
  return report::read_line<Outcome>(text, "the stored outcome of a task");
}

/// The outcome of `work`, or the reason for which it cannot be done.
template <typename Work>
auto attempted(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    decltype(work()) outcome;
    outcome.failure = error.what();
    return outcome;
  }
}

/// Calls take(task, outcome, seconds) for every outcome there is, in the order of the tasks, one
/// read at a time; counts what failed and what is not run yet and sets the status.
template <typename Outcome, typename Take>
void for_each_outcome(const TaskOutcomes& outcomes, StudyResult& result, const Take& take) {
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    std::optional<FinishedTask> finished = outcomes[task];
    if (!finished) {
      ++result.pending_tasks;
      continue;
    }
    auto outcome = read_outcome<Outcome>(finished->outcome);
    if (!outcome.failure.empty()) ++result.failed_tasks;
    take(task, std::move(outcome), finished->seconds);
  }
  if (result.failed_tasks == 0) return;
  const bool all = result.failed_tasks + result.pending_tasks == outcomes.size();
  result.status = all ? report::Status::kFailed : report::Status::kSomeFailed;
}

}  // namespace modcal
