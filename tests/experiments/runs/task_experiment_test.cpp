#include "experiments/runs/task_experiment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cstdlib>

#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::task_experiment_test {
namespace {

// Outcome of task i is i²; counts how often tasks are run.
class Squares final : public TaskExperiment {
 public:
  explicit Squares(std::size_t tasks) : tasks_(tasks) {}
  std::vector<Finding> lint() const override { return {}; }
  std::vector<PlanLine> plan() const override { return {}; }
  std::string_view for_structures() const override { return {}; }
  std::size_t task_count() const override { return tasks_; }
  std::vector<std::string> axes() const override { return {"i"}; }
  std::vector<std::string> axis_values(std::size_t task) const override {
    return {std::to_string(task)};
  }
  std::string fingerprint(std::size_t task, const std::filesystem::path&) const override {
    return std::to_string(task) + (runs >= written_after ? " of another file" : "");
  }
  std::string run_task(std::size_t task, const StudyContext&) const override {
    if (++runs >= stop_after) wish = true;
    return std::to_string(task * task);
  }
  std::string failure_in(const std::string&) const override { return {}; }
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext&) const override {
    StudyResult result;
    for (std::size_t task = 0; task < outcomes.size(); ++task) {
      const std::optional<FinishedTask> outcome = outcomes[task];
      result.summary += (outcome ? outcome->outcome : "-") + " ";
      if (!outcome) ++result.pending_tasks;
    }
    return result;
  }
  StudyResult replay(std::size_t, const StudyContext&) const override { return {}; }

  mutable std::atomic<int> runs{0};
  int stop_after = 1000, written_after = 1000;
  mutable std::atomic<bool> wish{false};

 private:
  std::size_t tasks_;
};

class TaskList : public FolderTest {
 protected:
  StudyContext context() { return {.work = work}; }

  SharedWork work;
};

TEST_F(TaskList, StandsInOrderWhateverTheThreads) {
  const Squares squares(5);
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(squares.run(context()).summary, "0 1 4 9 16 ");
  }
}

TEST_F(TaskList, GoesOnAfterAnInterruptionWithoutRepeatingWork) {
  Squares squares(9);
  squares.stop_after = 4;
  StudyContext stopping = context();
  stopping.stop = StopToken(squares.wish);
  {
    RunStore store(folder(), {}, "p");
    EXPECT_THROW(run_tasks(squares, stopping, &store, {}), Interrupted);
  }
  EXPECT_GE(squares.runs, 4);
  RunStore store(folder(), {}, "p");
  const auto outcomes = run_tasks(squares, context(), &store, {});
  EXPECT_EQ(squares.runs, 9);
  EXPECT_EQ(squares.sum_up(outcomes, context()).summary, squares.run(context()).summary);
}

// Task 3 may have read either content of its file: it is no result of both.
TEST_F(TaskList, EndsWhereAFileItReadsChanges) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  Squares squares(9);
  squares.written_after = 4;
  {
    RunStore store(folder(), {}, "p");
    EXPECT_THAT(refusal_of([&] { run_tasks(squares, context(), &store, {}); }),
                testing::HasSubstr("a file that the list reads has changed"));
  }
  EXPECT_EQ(squares.runs, 4);
  // With the file as it is now all of them are run; with the one before all but three.
  for (const int written_after : {0, 1000}) {
    squares.written_after = written_after;
    squares.runs = 0;
    RunStore store(folder(), {}, "p");
    run_tasks(squares, context(), &store, {});
    EXPECT_EQ(squares.runs, written_after == 0 ? 9 : 6);
  }
}

TEST_F(TaskList, RunsTheTasksOfAShardAndTakesThoseOfOthersFromTheStore) {
  const Squares squares(7);
  for (std::size_t index = 1; index <= 3; ++index) {
    const Shard shard{index, 3};
    RunStore store(folder(), shard, "p");
    const auto outcomes = run_tasks(squares, context(), &store, shard);
    const StudyResult result = squares.sum_up(outcomes, context());
    std::size_t done = 0;
    for (std::size_t k = 1; k <= index; ++k) done += Shard{k, 3}.size(7);
    EXPECT_EQ(result.pending_tasks, 7 - done);
  }
  EXPECT_EQ(squares.runs, 7);
}

TEST_F(TaskList, LetsAnErrorOfATaskThrough) {
  class Wrong final : public TaskExperiment {
   public:
    std::vector<Finding> lint() const override { return {}; }
    std::vector<PlanLine> plan() const override { return {}; }
    std::string_view for_structures() const override { return {}; }
    std::size_t task_count() const override { return 3; }
    std::vector<std::string> axes() const override { return {}; }
    std::vector<std::string> axis_values(std::size_t) const override { return {}; }
    std::string fingerprint(std::size_t task, const std::filesystem::path&) const override {
      return std::to_string(task);
    }
    std::string run_task(std::size_t task, const StudyContext&) const override {
      if (task == 1) throw std::runtime_error("a bug");
      return "{}";
    }
    std::string failure_in(const std::string&) const override { return {}; }
    StudyResult sum_up(const TaskOutcomes&, const StudyContext&) const override { return {}; }
    StudyResult replay(std::size_t, const StudyContext&) const override { return {}; }
  };
  EXPECT_THROW(Wrong().run(context()), std::runtime_error);
}

}  // namespace
}  // namespace modcal::task_experiment_test
