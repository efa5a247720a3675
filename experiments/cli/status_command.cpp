#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/cli/stored_run.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

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
    if (!run.list().failure_in(finished->outcome).empty()) ++counts.failed;
  }
  if (!seconds.empty()) counts.median_seconds = quantile(std::move(seconds), 0.5);
  return counts;
}

ExitCode status(const std::string& out, bool json) {
  const StoredRun run(out);
  const Counts counts = count(run);
  const bool running = is_running(journal_folder(out));
  for (const JournalDamage& damage : run.damages()) {
    fmt::print(stderr, "{} {}\n", colored("warning:"), message_of(damage));
  }
  if (json) {
    const nlohmann::ordered_json object = {{"kind", run.loaded().kind},
                                           {"title", run.loaded().title},
                                           {"running", running},
                                           {"tasks", counts.all},
                                           {"done", counts.done},
                                           {"failed", counts.failed},
                                           {"pending", counts.pending()},
                                           {"damaged_lines", run.damages().size()},
                                           {"median_task_seconds", counts.median_seconds},
                                           {"left_core_seconds", counts.left_seconds()},
                                           {"command", run.command()}};
    fmt::print("{}\n", object.dump(2));
    return ExitCode::kOk;
  }
  fmt::print("{}: {}\n{} of {} tasks done, {} failed, {} to do\n", run.loaded().kind,
             run.loaded().title, counts.done, counts.all, counts.failed, counts.pending());
  fmt::print("{}\n", running ? "a run works here now" : "no run works here");
  if (counts.done > 0) {
    fmt::print("a task took {:.3g} s (median)", counts.median_seconds);
    if (counts.pending() > 0)
      fmt::print("; about {:.3g} core-seconds to go", counts.left_seconds());
    fmt::print("\n");
  }
  if (counts.pending() > 0 && !running) fmt::print("go on with:\n  {}\n", run.command());
  return ExitCode::kOk;
}

}  // namespace

void add_status_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand("status", "Say how far a run is, running or dead");
  auto out = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("folder", *out, "folder of the results")->required();
  command->add_flag("--json", *json, "as JSON");
  command->callback([=] { chosen([=] { return status(*out, *json); }); });
}

}  // namespace modcal
