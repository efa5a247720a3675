// What a list of tasks costs besides its tasks: scheduling and journal, memory, merge, threads.
//
// task_list_benchmark [TASKS]: lists of 10^4, 10^5, … up to TASKS (default 10^6) empty tasks with
// outcomes of the size that a benchmark's have, then one of busy tasks in one and two threads.
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "experiments/runs/results_database.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Resident memory [MB].
double resident() {
  std::ifstream stream("/proc/self/statm");
  double total = 0.0, pages = 0.0;
  stream >> total >> pages;
  return 1e-6 * pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// Tasks that take `spins` steps of arithmetic and leave an outcome of 600 bytes.
class Tasks final : public TaskExperiment {
 public:
  Tasks(std::size_t count, int spins) : count_(count), spins_(spins) {}
  std::vector<Finding> lint() const override { return {}; }
  std::vector<PlanLine> plan() const override { return {}; }
  std::string_view for_structures() const override { return {}; }
  std::size_t task_count() const override { return count_; }
  std::vector<std::string> axes() const override { return {"noise", "seed"}; }
  std::vector<std::string> axis_values(std::size_t task) const override {
    return {std::to_string(task % 8), std::to_string(task / 8)};
  }
  std::string fingerprint(std::size_t task, const std::filesystem::path&) const override {
    return fmt::format("task {} of {}", task, spins_);
  }
  std::string run_task(std::size_t task, const StudyContext&) const override {
    double x = 0.5;
    for (int i = 0; i < spins_; ++i) x = 3.9 * x * (1.0 - x);
    return fmt::format(R"({{"task":{},"value":{},"filling":"{}"}})", task, x, filling_);
  }
  std::string failure_in(const std::string&) const override { return {}; }
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext&) const override {
    std::size_t bytes = 0;
    for (std::size_t task = 0; task < outcomes.size(); ++task)
      bytes += outcomes[task]->outcome.size();
    StudyResult result;
    result.summary = std::to_string(bytes);
    return result;
  }
  StudyResult replay(std::size_t, const StudyContext&) const override { return {}; }

 private:
  std::size_t count_;
  int spins_;
  std::string filling_ = std::string(560, 'x');
};

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "modcal-list-XXXXXX").string();
    MODCAL_REQUIRE(mkdtemp(name.data()) != nullptr, "no temporary folder");
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path path;
};

void measure_list(std::size_t count) {
  const Folder folder;
  const Tasks tasks(count, 0);
  SharedWork work;
  const StudyContext context{.work = work};
  const auto per_task = [count](double seconds) {
    return 1e6 * seconds / static_cast<double>(count);
  };
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const double start = processor_seconds();
    RunStore store(folder.path, {}, "benchmark");
    const TaskOutcomes outcomes = run_tasks(tasks, context, &store, {});
    const double ran = processor_seconds();
    const StudyResult result = tasks.sum_up(outcomes, context);
    fmt::print("{:>8} tasks: {:.2f} us a task, {:.2f} us to sum up; {:.0f} MB resident\n", count,
               per_task(ran - start), per_task(processor_seconds() - ran), resident());
  }
  const double start = now(), processor = processor_seconds();
  const FinishedTasks finished(folder.path, "benchmark");
  const TaskOutcomes outcomes = stored_outcomes(tasks, finished, folder.path);
  ResultsDatabase database(folder.path / "results.sqlite", tasks.axes());
  for (std::size_t task = 0; task < count; ++task) {
    std::optional<FinishedTask> done = outcomes[task];
    std::string failure = tasks.failure_in(done->outcome);
    database.add({task, tasks.axis_values(task), std::move(failure), std::move(done->outcome),
                  done->seconds});
  }
  const std::string digest = database.finish({});
  fmt::print("{:>8} rows merged: {:.2f} s wall, {:.2f} s of processor; {:.0f} MB resident\n", count,
             now() - start, processor_seconds() - processor, resident());
}

void measure_threads() {
  const Tasks tasks(2000, 1000000);
  double wall[2] = {}, processor[2] = {};
  for (const int threads : {1, 2}) {
    const Folder folder;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    SharedWork work;
    RunStore store(folder.path, {}, "benchmark");
    const double start = now(), spent = processor_seconds();
    run_tasks(tasks, {.work = work}, &store, {});
    wall[threads - 1] = now() - start;
    processor[threads - 1] = processor_seconds() - spent;
  }
  fmt::print(
      "2000 busy tasks: {:.2f} s in one thread, {:.2f} s in two, {:.2f} x; processor time "
      "{:.2f} and {:.2f} s: {:.2f} x where both processors are free\n",
      wall[0], wall[1], wall[0] / wall[1], processor[0], processor[1],
      2.0 * processor[0] / processor[1]);
}

int main_of(int argc, char** argv) {
  const std::size_t most = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1000000;
  fmt::print("at first: {:.0f} MB resident\n", resident());
  for (std::size_t count = 10000; count <= most; count *= 10) measure_list(count);
  measure_threads();
  return 0;
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  try {
    return modcal::main_of(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
