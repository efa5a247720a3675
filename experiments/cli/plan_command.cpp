#include <ctime>
#include <set>
#include <thread>

#include "experiments/cli/command.hpp"
#include "experiments/memory.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "experiments/study/sample.hpp"
#include "libsim/dynamics/plan.hpp"

namespace modcal {
namespace {

using PlanArguments = ExperimentArguments;

struct Price {
  double core_seconds = 0.0;         ///< processor time of everything that is priced [s]
  std::optional<double> disk_bytes;  ///< of the journal of a list's outcomes
  std::string basis;                 ///< what was measured
};

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Checksum, key, number and time of a line of the journal, about.
constexpr double kJournalOverhead = 70.0;

// The k-th of the numbers that fill [0, count) evenly, however many are taken.
std::size_t spread_index(std::size_t k, std::size_t count) {
  const double share = std::fmod(0.5 + 0.6180339887498949 * static_cast<double>(k), 1.0);
  return static_cast<std::size_t>(share * static_cast<double>(count));
}

// What takes longer is not done to its end to tell what a task costs [s].
constexpr double kLongTask = 10.0;

// Of a list of which not even one task ends in time.
Price price_beyond(double count) {
  return {.core_seconds = count * kLongTask,
          .disk_bytes = {},
          .basis = fmt::format("at least: no task ended within {:g} s", kLongTask)};
}

// Price of a list of tasks: does tasks that stand evenly in it, for about a second of
// processor time. `simulations`: distinct simulations that the tasks share; what one costs is told
// from the tasks that needed a new one. Throws InvalidInput where a task cannot be done at all.
Price price_of_tasks(const TaskExperiment& list, std::size_t simulations,
                     const StudyContext& context) {
  constexpr double kBudget = 1.0;  // [s] of processor time
  const std::size_t count = list.task_count();
  std::set<std::size_t> done;
  Sample with_simulation, without, bytes;
  const double start = processor_seconds();
  for (std::size_t k = 0; done.size() < count && processor_seconds() - start < kBudget; ++k) {
    const std::size_t task = k < 4 * count ? spread_index(k, count) : k - 4 * count;
    if (task >= count) break;
    if (!done.insert(task).second) continue;
    const std::size_t before = context.work.truths.simulated();
    const double begin = processor_seconds();
    std::string outcome;
    try {
      outcome = list.run_task(task, context);
    } catch (const Interrupted&) {
      if (interrupted()) throw;
      done.erase(task);
      if (done.empty()) return price_beyond(static_cast<double>(count));
      break;
    }
    const double seconds = processor_seconds() - begin;
    (context.work.truths.simulated() > before ? with_simulation : without).add(seconds);
    bytes.add(static_cast<double>(outcome.size()) + kJournalOverhead);
  }
  Price price;
  const auto tasks = static_cast<double>(count);
  const bool some_new = !with_simulation.values.empty();
  if (some_new && !without.values.empty()) {
    price.core_seconds = tasks * without.known_mean() +
                         static_cast<double>(simulations) *
                             std::max(0.0, with_simulation.known_mean() - without.known_mean());
  } else {
    price.core_seconds = tasks * (some_new ? with_simulation : without).known_mean();
  }
  price.disk_bytes = tasks * bytes.known_mean();
  price.basis = fmt::format("measured on {} of {} tasks, {:.2g} s", done.size(), count,
                            processor_seconds() - start);
  return price;
}

// Price of the simulations alone.
Price price_of_simulations(const SimulationPlan& plan, const PlannedSimulations& planned) {
  const double duration = planned.truth.scene.duration;
  return {.core_seconds = static_cast<double>(planned.count) * plan.seconds(duration),
          .disk_bytes = {},
          .basis = fmt::format("the simulation alone, measured on the first {:.3g} s of {:g} s",
                               plan.piece, duration)};
}

// "27.3 core-seconds (0.00758 core-hours), 13.6 s on 2 threads, 0.94 MB on disk".
std::string text_of(const Price& price, std::size_t threads) {
  std::string text = fmt::format("{:.3g} core-seconds ({:.3g} core-hours)", price.core_seconds,
                                 price.core_seconds / 3600.0);
  if (threads > 1) {
    text += fmt::format(", {:.3g} s on {} threads",
                        price.core_seconds / static_cast<double>(threads), threads);
  }
  if (price.disk_bytes) text += fmt::format(", {:.3g} MB on disk", 1e-6 * *price.disk_bytes);
  return text;
}

SimulationPlan plan_of(const PlannedSimulations& planned) {
  return plan_simulation(planned.truth.scene, *planned.truth.simulator.make(), planned.sample_rate,
                         planned.outputs);
}

struct Plan {
  std::vector<PlanLine> lines;
  std::optional<SimulationPlan> simulation;
  double duration = 0.0;
  std::optional<Price> price;
  double memory = 0.0;  // that a run needs, about [B]
};

// A wish to stop that comes from the user or, `seconds` after it was made, from the clock.
class Deadline {
 public:
  explicit Deadline(double seconds)
      : clock_([this, seconds, user = interrupt_token()](const std::stop_token& done) {
          constexpr std::chrono::milliseconds kPeriod(20);
          const Stopwatch since;
          while (!done.stop_requested() && !user.requested() && since.seconds() < seconds) {
            std::this_thread::sleep_for(kPeriod);
          }
          passed_ = true;
        }) {}
  StopToken token() const { return StopToken(passed_); }

 private:
  std::atomic<bool> passed_{false};
  std::jthread clock_;  // last: it ends before what it sets
};

Plan make_plan(const LoadedExperiment& loaded) {
  Plan plan{
      .lines = loaded.experiment->plan(), .simulation = {}, .price = {}, .memory = loaded.memory};
  const auto planned = loaded.experiment->planned_simulations();
  if (planned) {
    plan.duration = planned->truth.scene.duration;
    plan.simulation = plan_of(*planned);
  }
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  const bool is_short = !plan.simulation || plan.simulation->seconds(plan.duration) < kLongTask;
  if (list != nullptr && is_short) {
    const Deadline deadline(kLongTask);
    SharedWork work(deadline.token());
    const std::filesystem::path folder = loaded.document.folder();
    plan.price = price_of_tasks(*list, planned ? planned->count : 0,
                                {.work = work,
                                 .folder = folder.empty() ? "." : folder,
                                 .command = {},
                                 .stop = deadline.token()});
  } else if (planned) {
    plan.price = price_of_simulations(*plan.simulation, *planned);
    for (const PlannedSimulations& other : planned->others) {
      plan.price->core_seconds += price_of_simulations(plan_of(other), other).core_seconds;
    }
  }
  return plan;
}

// Saving of a whole record beside its cost without the skip [s].
struct Saving {
  double seconds, percent;
};
Saving saving_of(const Skip& skip, const Plan& plan) {
  const double seconds = std::max(0.0, skip.saved_seconds) * plan.duration;
  return {seconds, 100.0 * seconds / (seconds + plan.simulation->seconds(plan.duration))};
}

void print_text(const Plan& plan, std::size_t threads) {
  for (const PlanLine& line : plan.lines) say("{}\n", line.text);
  if (plan.simulation) {
    const SimulationPlan& one = *plan.simulation;
    say("modes: {} of {} move\n", one.modes_moved, one.modes);
    say("one simulation: {:.3g} ms, {:.3g} of it set-up; {:.3g} steps, the longest {:.3g} s\n",
        1e3 * one.seconds(plan.duration), 1e3 * one.set_up_seconds,
        one.steps_per_second * plan.duration, one.time_step);
    for (const Skip& skip : one.skips) {
      const Saving saving = saving_of(skip, plan);
      say("skipped: {}\n  because {}\n  saves {:.2g} ms ({:.0f} %) a simulation; {}\n", skip.what,
          skip.reason, 1e3 * saving.seconds, saving.percent, skip.note);
    }
  }
  if (plan.memory > 0.0) {
    say("memory: about {} of {}\n", bytes_text(plan.memory), bytes_text(machine_memory()));
  }
  if (plan.price) {
    say("price: {}\n  {}\n", text_of(*plan.price, threads), plan.price->basis);
  }
}

void print_plan_json(const LoadedExperiment& loaded, const Plan& plan, std::size_t threads) {
  nlohmann::ordered_json object = {
      {"kind", loaded.kind}, {"title", loaded.title}, {"work", facts_of(plan.lines)}};
  if (plan.simulation) {
    const SimulationPlan& one = *plan.simulation;
    auto skips = nlohmann::ordered_json::array();
    for (const Skip& skip : one.skips) {
      const Saving saving = saving_of(skip, plan);
      skips.push_back({{"what", skip.what},
                       {"reason", skip.reason},
                       {"saved_seconds", saving.seconds},
                       {"saved_percent", saving.percent},
                       {"note", skip.note}});
    }
    object["simulation"] = {{"modes", one.modes},
                            {"modes_moved", one.modes_moved},
                            {"samples", one.samples},
                            {"longest_step", one.time_step},
                            {"steps", one.steps_per_second * plan.duration},
                            {"set_up_seconds", one.set_up_seconds},
                            {"seconds", one.seconds(plan.duration)},
                            {"measured_on_first", one.piece},
                            {"skips", std::move(skips)}};
  }
  if (plan.memory > 0.0) object["memory_bytes"] = plan.memory;
  if (plan.price) {
    const Price& price = *plan.price;
    object["price"] = {{"core_seconds", price.core_seconds},
                       {"core_hours", price.core_seconds / 3600.0},
                       {"threads", threads},
                       {"seconds", price.core_seconds / static_cast<double>(threads)},
                       {"basis", price.basis}};
    if (price.disk_bytes) object["price"]["disk_bytes"] = *price.disk_bytes;
  }
  print_json(object);
}

ExitCode plan(const PlanArguments& arguments) {
  const auto loaded =
      load_and_print_mistakes(arguments.file, arguments.assignments, arguments.means());
  if (!loaded) return ExitCode::kInvalidInput;
  const Plan made = make_plan(*loaded);
  // A run that is no list of tasks simulates on one thread.
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded->experiment.get());
  const std::size_t tasks = list != nullptr ? list->task_count() : 1;
  const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1,
                                                      std::max<std::size_t>(tasks, 1));
  if (answer_style().json) {
    print_plan_json(*loaded, made, threads);
  } else {
    print_text(made, threads);
  }
  return ExitCode::kOk;
}

void declare(CLI::App& command, PlanArguments& arguments) { arguments.declare_file(command); }

}  // namespace

void add_plan_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "plan", "Say what a run would do, skip and cost", declare, plan);
}

}  // namespace modcal
