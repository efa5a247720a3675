#include "experiments/task_experiment.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>

#include "libsim/base/task_loop.hpp"

namespace modcal {
namespace {

using Outcomes = std::vector<std::optional<FinishedTask>>;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct PendingTask {
  std::size_t task = 0;
  std::string key;
};

// Fills in what the store holds and names what the shard has to run.
std::vector<PendingTask> pending_tasks(const TaskExperiment& experiment,
                                       const StudyContext& context, const RunStore* store,
                                       const Shard& shard, Outcomes& outcomes) {
  std::vector<PendingTask> pending;
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    std::string key;
    if (store != nullptr) {
      key = store->finished().key_of(experiment.fingerprint(task, context.folder));
      if (const JournalRecord* record = store->finished().find(key)) {
        outcomes[task] = {record->outcome, record->seconds};
        continue;
      }
    }
    if (shard.holds(task)) pending.push_back({task, std::move(key)});
  }
  return pending;
}

}  // namespace

Outcomes run_tasks(const TaskExperiment& experiment, const StudyContext& context, RunStore* store,
                   const Shard& shard) {
  Outcomes outcomes(experiment.task_count());
  const std::vector<PendingTask> pending =
      pending_tasks(experiment, context, store, shard, outcomes);
  const auto all = static_cast<double>(shard.size(outcomes.size()));
  std::atomic<std::size_t> left{pending.size()};
  const auto run = [&](std::size_t i) {
    const auto start = std::chrono::steady_clock::now();
    const PendingTask& next = pending[i];
    FinishedTask finished{experiment.run_task(next.task, context), 0.0};
    finished.seconds = seconds_since(start);
    if (store != nullptr) {
      store->append({next.key, next.task, finished.seconds, finished.outcome});
    }
    outcomes[next.task] = std::move(finished);
    context.progress(1.0 - static_cast<double>(--left) / all);
  };
  for_each_task(pending.size(), run, context.stop);
  return outcomes;
}

StudyResult TaskExperiment::run(const StudyContext& context) const {
  return sum_up(run_tasks(*this, context, nullptr, Shard{}), context);
}

}  // namespace modcal
