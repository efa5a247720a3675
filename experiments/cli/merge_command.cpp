#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/cli/stored_run.hpp"
#include "experiments/runs/results_database.hpp"

namespace modcal {
namespace {

// Row by row: what is held does not grow with the list.
std::size_t add_rows(const StoredRun& run, ResultsDatabase& database) {
  std::size_t done = 0;
  for (std::size_t task = 0; task < run.tasks(); ++task) {
    std::optional<FinishedTask> finished = run.outcomes()[task];
    if (!finished) continue;
    std::string failure = run.list().failure_in(finished->outcome);
    database.add({task, run.list().axis_values(task), std::move(failure),
                  std::move(finished->outcome), finished->seconds});
    ++done;
  }
  return done;
}

ExitCode merge(const std::string& out) {
  const StoredRun run(out);
  for (const JournalDamage& damage : run.damages()) {
    fmt::print(stderr, "{} {}\n", colored("warning:"), message_of(damage));
  }
  const std::filesystem::path file = std::filesystem::path(out) / "results.sqlite";
  ResultsDatabase database(file, run.list().axes());
  const std::size_t done = add_rows(run, database);
  const std::string digest = database.finish({{"kind", run.loaded().kind},
                                              {"title", run.loaded().title},
                                              {"command", run.command()},
                                              {"tasks", std::to_string(run.tasks())},
                                              {"done", std::to_string(done)}});
  fmt::print("{}: {} of {} tasks, digest {}\n", file.string(), done, run.tasks(), digest);
  return ExitCode::kOk;
}

}  // namespace

void add_merge_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("merge", "Put the results of all journals into one SQLite file");
  auto out = std::make_shared<std::string>();
  command->add_option("folder", *out, "folder of the results")->required();
  command->callback([=] { chosen([=] { return merge(*out); }); });
}

}  // namespace modcal
