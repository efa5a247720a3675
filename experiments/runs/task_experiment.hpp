// An experiment that is a list of tasks: it can be stopped, resumed, split over machines and asked
// for a single task again.
#pragma once

#include <chrono>

#include "experiments/experiment.hpp"
#include "experiments/report/result.hpp"
#include "experiments/runs/run_store.hpp"

namespace modcal {

/// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// What one task has left.
struct FinishedTask {
  std::string outcome;   ///< JSON on one line
  double seconds = 0.0;  ///< time it took; the only part that differs between runs
};

/// Outcomes of a list by task. With a store they stay in its journals, 16 bytes a task are kept
/// here, and each is read when it is asked for.
class TaskOutcomes {
 public:
  /// Nothing is finished. `finished` null: outcomes are kept here.
  explicit TaskOutcomes(std::size_t tasks, const FinishedTasks* finished = nullptr);

  std::size_t size() const { return finished_ != nullptr ? places_.size() : kept_.size(); }
  bool has(std::size_t task) const {
    return finished_ != nullptr ? places_[task].is_known() : kept_[task].has_value();
  }
  /// Records of the store that are outcomes of its tasks; equal tasks share one.
  std::size_t records() const;
  /// nullopt: not run yet.
  std::optional<FinishedTask> operator[](std::size_t task) const;
  /// What read(outcome) makes of the outcome of a finished task; the InvalidInput that it throws
  /// for one that no run has written names the journal's line.
  template <typename Read>
  auto read(std::size_t task, const std::string& outcome, const Read& read) const
      -> decltype(read(outcome)) {
    try {
      return read(outcome);
    } catch (const InvalidInput& error) {
      refuse(task, error);
    }
  }

  /// Different tasks may be put from different threads.
  void put(std::size_t task, const RecordPlace& place) { places_[task] = place; }
  void put(std::size_t task, FinishedTask finished) { kept_[task] = std::move(finished); }

 private:
  [[noreturn]] void refuse(std::size_t task, const InvalidInput& error) const;

  const FinishedTasks* finished_;
  std::vector<RecordPlace> places_;
  std::vector<std::optional<FinishedTask>> kept_;
};

class TaskExperiment : public Experiment {
 public:
  virtual std::size_t task_count() const = 0;
  /// Paths of the options that differ between tasks.
  virtual std::vector<std::string> axes() const = 0;
  /// Their values in one task, as written in the file.
  virtual std::vector<std::string> axis_values(std::size_t task) const = 0;
  /// Text that is equal for tasks with equal outcomes and says everything an outcome depends on
  /// but the program. `folder`: where relative paths start.
  virtual std::string fingerprint(std::size_t task, const std::filesystem::path& folder) const = 0;

  /// Outcome of one task as JSON on one line; a task that cannot be done has the reason in its
  /// outcome. Safe to call from several threads.
  virtual std::string run_task(std::size_t task, const StudyContext& context) const = 0;
  /// The reason in an outcome why its task failed, its member "failure"; empty where it did not.
  /// Throws InvalidInput for a text that is no outcome.
  virtual std::string failure_in(const std::string& outcome) const;
  /// What loss_in() measures, for people; empty: tasks of this kind have no score.
  virtual std::string loss_name() const { return {}; }
  /// How wrong an outcome is, > 0; nullopt where its task failed.
  virtual std::optional<double> loss_in(const std::string& /*outcome*/) const { return {}; }
  /// A number of an outcome by its name; nullopt where it has none of that name.
  std::optional<double> number_in(const std::string& outcome, const std::string& name) const;
  /// The names of its numbers.
  std::vector<std::string> numbers_in(const std::string& outcome) const;
  /// Tables, figures and acceptance of the outcomes there are; nullopt: not run yet.
  virtual StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const = 0;
  /// One task again, with everything drawn and written that can be.
  virtual StudyResult replay(std::size_t task, const StudyContext& context) const = 0;

  /// Runs every task over threads, without a store.
  StudyResult run(const StudyContext& context) const final;
};

/// Outcomes of all tasks of the experiment that are finished once the shard's tasks are: those the
/// store holds already are not run again, the others are put into it as they finish. The results
/// stand in the order of the tasks whatever the threads. `store` may be null, otherwise it must
/// outlive the outcomes. Throws Interrupted where the context says so; what has finished by then is
/// in the store.
TaskOutcomes run_tasks(const TaskExperiment& experiment, const StudyContext& context,
                       RunStore* store, const Shard& shard);

/// Outcomes of what the store had finished when it was scanned; `finished` must outlive them.
TaskOutcomes stored_outcomes(const TaskExperiment& experiment, const FinishedTasks& finished,
                             const std::filesystem::path& folder);

// Outcomes of one type in the store. Such a type has the member `failure`, why there is nothing
// else in it (empty: there is), and a visit(ResultVisitor&) that describes it.

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

/// Counts the task among those of its reason.
void add_reason(std::size_t task, const std::string& reason, std::vector<TasksOfReason>& reasons);

/// A warning of each reason: how many tasks, the first of them, and what the first was warned of.
void warn_of(const std::vector<TasksOfReason>& reasons, StudyResult& result);

/// Counts the failed task among those of its reason.
void add_failure(std::size_t task, const std::string& reason, StudyResult& result);

/// Calls take(task, outcome, seconds) for every outcome there is, in the order of the tasks, one
/// read at a time; counts what failed and what is not run yet and sets the status. read(text):
/// throws InvalidInput for what cannot be the outcome of a task.
template <typename Outcome, typename Take, typename Read = Outcome (*)(const std::string&)>
void for_each_outcome(const TaskOutcomes& outcomes, StudyResult& result, const Take& take,
                      const Read& read = read_outcome<Outcome>) {
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    std::optional<FinishedTask> finished = outcomes[task];
    if (!finished) {
      ++result.pending_tasks;
      continue;
    }
    auto outcome = outcomes.read(task, finished->outcome, read);
    if (!outcome.failure.empty()) add_failure(task, outcome.failure, result);
    take(task, std::move(outcome), finished->seconds);
  }
  if (result.failed_tasks == 0) return;
  const bool all = result.failed_tasks + result.pending_tasks == outcomes.size();
  result.status = all ? report::Status::kFailed : report::Status::kSomeFailed;
}

}  // namespace modcal
