// status, merge, report and replay: what is done with the folders that runs have left.
#include <charconv>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/cli/output_directory.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/runs/results_database.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr std::string_view kNotFinished =
    "by this program and with the files as they are now it is not finished: no result shown is its";

struct FolderArguments {
  std::string folder;
  std::size_t task = 0;
};

void declare_folder(CLI::App& command, FolderArguments& arguments) {
  command.add_option("folder", arguments.folder, "folder of the results")->required();
}

void print_damages(const StoredRun& run) {
  for (const JournalDamage& damage : run.damages()) {
    warn("{}", message_of(damage));
  }
}

std::string failure_of(const StoredRun& run, std::size_t task, const FinishedTask& finished) {
  return run.outcomes().read(task, finished.outcome, [&run](const std::string& outcome) {
    return run.list().failure_in(outcome);
  });
}

struct Counts {
  std::size_t all = 0, done = 0, failed = 0;
  double median_seconds = 0.0;
  std::size_t pending() const { return all - done; }
  /// Of one core, if the rest costs what the finished tasks did [s].
  double left_seconds() const { return median_seconds * static_cast<double>(pending()); }
};

Counts count(const StoredRun& run) {
  Counts counts{.all = run.tasks()};
  std::vector<double> seconds;
  for (std::size_t task = 0; task < run.tasks(); ++task) {
    const std::optional<FinishedTask> finished = run.outcomes()[task];
    if (!finished) continue;
    ++counts.done;
    seconds.push_back(finished->seconds);
    if (!failure_of(run, task, *finished).empty()) ++counts.failed;
  }
  if (!seconds.empty()) counts.median_seconds = quantile(std::move(seconds), 0.5);
  return counts;
}

ExitCode status(const FolderArguments& arguments) {
  const StoredRun run(arguments.folder);
  const Counts counts = count(run);
  const bool running = is_running(journal_folder(arguments.folder));
  print_damages(run);
  if (answer_style().json) {
    print_json({{"kind", run.loaded().kind},
                {"title", run.loaded().title},
                {"running", running},
                {"tasks", counts.all},
                {"done", counts.done},
                {"failed", counts.failed},
                {"pending", counts.pending()},
                {"other_results", run.other_results()},
                {"damaged_lines", run.damages().size()},
                {"median_task_seconds", counts.median_seconds},
                {"left_core_seconds", counts.left_seconds()},
                {"command", run.command_from_here()}});
    return ExitCode::kOk;
  }
  say("{}: {}\n{} of {} tasks done, {} failed, {} to do\n", run.loaded().kind, run.loaded().title,
      counts.done, counts.all, counts.failed, counts.pending());
  if (run.other_results() > 0) {
    say("{} results of other settings, records or programs lie here and do not count\n",
        run.other_results());
  }
  say("{}\n", running ? "a run works here now" : "no run works here");
  if (counts.done > 0) {
    say("a task took {:.3g} s (median)", counts.median_seconds);
    if (counts.pending() > 0) say("; about {:.3g} core-seconds to go", counts.left_seconds());
    say("\n");
  }
  if (counts.pending() > 0 && !running) say("go on with:\n  {}\n", run.command_from_here());
  return ExitCode::kOk;
}

// Row by row: what is held does not grow with the list.
std::size_t add_rows(const StoredRun& run, ResultsDatabase& database) {
  std::size_t done = 0;
  for (std::size_t task = 0; task < run.tasks(); ++task) {
    std::optional<FinishedTask> finished = run.outcomes()[task];
    if (!finished) continue;
    std::string failure = failure_of(run, task, *finished);
    database.add({task, run.list().axis_values(task), std::move(failure),
                  std::move(finished->outcome), finished->seconds});
    ++done;
  }
  return done;
}

ExitCode merge(const FolderArguments& arguments) {
  const StoredRun run(arguments.folder);
  print_damages(run);
  run.require_some_done();
  OutputDirectory out(run.out());
  const std::filesystem::path file = run.out() / kDatabaseFile;
  MODCAL_REQUIRE(out.foreign_among({kDatabaseFile}).empty(),
                 "{}: no run of modcal wrote this file; move it away", file.string());
  out.announce({kDatabaseFile});  // first: one that is not announced is somebody else's
  ResultsDatabase database(file, run.list().axes());
  const std::size_t done = add_rows(run, database);
  const std::string digest = database.finish({{"kind", run.loaded().kind},
                                              {"title", run.loaded().title},
                                              {"command", run.command()},
                                              {"tasks", std::to_string(run.tasks())},
                                              {"done", std::to_string(done)}});
  add_to_json("database", file.string());
  add_to_json("tasks", run.tasks());
  add_to_json("done", done);
  add_to_json("digest", digest);
  say("{}: {} of {} tasks, digest {}\n", file.string(), done, run.tasks(), digest);
  return ExitCode::kOk;
}

StudyContext context_of(const StoredRun& run, SharedWork& work, std::string command) {
  return {.work = work, .folder = run.folder(), .command = std::move(command)};
}

ExitCode replay_task(const FolderArguments& arguments) {
  const auto& [out, task] = arguments;
  const StoredRun run(out);
  MODCAL_REQUIRE(task < run.tasks(), "task {} does not exist: {} has the tasks 0 to {}", task, out,
                 run.tasks() - 1);
  if (!run.outcomes().has(task)) warn("task {} of {}: {}", task, out, kNotFinished);
  auto cell = nlohmann::ordered_json::object();
  for (std::size_t axis = 0; axis < run.list().axes().size(); ++axis) {
    remark("{}: {}\n", run.list().axes()[axis], run.list().axis_values(task)[axis]);
    cell[run.list().axes()[axis]] = run.list().axis_values(task)[axis];
  }
  add_to_json("axes", cell);
  SharedWork work(interrupt_token());
  const std::string command = fmt::format("modcal replay {} {}", shell_word(out), task);
  StudyContext context = context_of(run, work, command);
  std::optional<Progress> progress(std::in_place, fmt::format("task {}", task), Progress::Of::kOne);
  context.progress = [&progress](double share) { progress->report(share); };
  const StudyResult result = run.list().replay(task, context);
  progress.reset();
  const std::filesystem::path folder =
      std::filesystem::path(out) / "replay" / fmt::format("task-{}", task);
  RunSettings settings = run.settings(folder.string());
  settings.command = command;
  settings.directory.clear();
  return present(run.loaded(), result, settings, 0.0);
}

std::string complaint_about_task(const std::string& text) {
  std::size_t task = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), task);
  if (error == std::errc() && end == text.data() + text.size()) return {};
  return fmt::format("\"{}\" is no task: they are numbered 0, 1, 2, ...", text);
}

// Its number first is the mistake of who thinks of the task first.
std::string complaint_about_folder(const std::string& text) {
  if (!complaint_about_task(text).empty() || std::filesystem::exists(text)) return {};
  return fmt::format(
      "\"{0}\" is no folder but a number: the two are exchanged, the task comes last, as in modcal "
      "replay out/table1 {0}",
      text);
}

void declare_replay(CLI::App& command, FolderArguments& arguments) {
  command.add_option("folder", arguments.folder, "folder of the results")
      ->required()
      ->check(complaint_about_folder);
  command.add_option("task", arguments.task, "number of the task, from 0; see tasks.csv")
      ->required()
      ->check(complaint_about_task);
}

ExitCode write_stored_report(const FolderArguments& arguments) {
  return report_stored_run(arguments.folder);
}

}  // namespace

ExitCode report_stored_run(const std::string& out) {
  const StoredRun run(out);
  print_damages(run);
  SharedWork work;
  run.require_some_done();
  const StudyResult result =
      run.list().sum_up(run.outcomes(), context_of(run, work, run.command()));
  return present(run.loaded(), result, run.settings(out), 0.0);
}

void add_stored_commands(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "status", "Say how far a run is, running or dead", declare_folder,
              status);
  add_command(app, chosen, "merge", "Put the results of all journals into one SQLite file",
              declare_folder, merge);
  add_command(app, chosen, "report", "Write the report of what a run has finished", declare_folder,
              write_stored_report);
  add_command(app, chosen, "replay", "Run one task of a run again and show all of it",
              declare_replay, replay_task);
}

}  // namespace modcal
