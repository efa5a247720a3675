#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/interrupt.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/cli/stored_run.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

RunSettings settings_of(const StoredRun& run, std::string out) {
  return {.out = std::move(out), .command = run.command(), .folder = run.folder()};
}

StudyContext context_of(const StoredRun& run, SharedWork& work, std::string command) {
  return {.work = work, .folder = run.folder(), .command = std::move(command)};
}

ExitCode replay_task(const std::string& out, std::size_t task) {
  const StoredRun run(out);
  MODCAL_REQUIRE(task < run.tasks(), "task {} does not exist: {} has the tasks 0 to {}", task, out,
                 run.tasks() - 1);
  for (std::size_t axis = 0; axis < run.list().axes().size(); ++axis) {
    fmt::print(stderr, "{}: {}\n", run.list().axes()[axis], run.list().axis_values(task)[axis]);
  }
  SharedWork work(interrupt_token());
  const std::string command = fmt::format("modcal replay {} {}", out, task);
  const StudyResult result = run.list().replay(task, context_of(run, work, command));
  const std::filesystem::path folder =
      std::filesystem::path(out) / "replay" / fmt::format("task-{}", task);
  RunSettings settings = settings_of(run, folder.string());
  settings.command = command;
  return present(run.loaded(), result, settings, 0.0);
}

}  // namespace

ExitCode report_stored_run(const std::string& out) {
  const StoredRun run(out);
  for (const JournalDamage& damage : run.damages()) {
    fmt::print(stderr, "{} {}\n", colored("warning:"), message_of(damage));
  }
  SharedWork work;
  const StudyResult result =
      run.list().sum_up(run.outcomes(), context_of(run, work, run.command()));
  MODCAL_REQUIRE(result.pending_tasks < run.tasks(), "{}: none of the {} tasks is done; run:\n  {}",
                 out, run.tasks(), run.command());
  return present(run.loaded(), result, settings_of(run, out), 0.0);
}

void add_report_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand("report", "Write the report of what a run has finished");
  auto out = std::make_shared<std::string>();
  command->add_option("folder", *out, "folder of the results")->required();
  command->callback([=] { chosen([=] { return report_stored_run(*out); }); });
}

void add_replay_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("replay", "Run one task of a run again and show all of it");
  auto out = std::make_shared<std::string>();
  auto task = std::make_shared<std::size_t>(0);
  command->add_option("folder", *out, "folder of the results")->required();
  command->add_option("task", *task, "number of the task, from 0; see tasks.csv")->required();
  command->callback([=] { chosen([=] { return replay_task(*out, *task); }); });
}

}  // namespace modcal
