#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/stored_run.hpp"
#include "experiments/store/results_database.hpp"

namespace modcal {
namespace {

std::vector<ResultRow> rows_of(const StoredRun& run) {
  std::vector<ResultRow> rows;
  for (std::size_t task = 0; task < run.records().size(); ++task) {
    const JournalRecord* record = run.records()[task];
    if (record == nullptr) continue;
    rows.push_back({task, run.list().axis_values(task), run.list().failure_in(record->outcome),
                    record->outcome, record->seconds});
  }
  return rows;
}

ExitCode merge(const std::string& out) {
  const StoredRun run(out);
  for (const JournalDamage& damage : run.damages()) {
    fmt::print(stderr, "warning: {}\n", message_of(damage));
  }
  const std::vector<ResultRow> rows = rows_of(run);
  const std::filesystem::path file = std::filesystem::path(out) / "results.sqlite";
  const std::string digest =
      write_results_database(file, run.list().axes(), rows,
                             {{"kind", run.loaded().kind},
                              {"title", run.loaded().title},
                              {"command", run.command()},
                              {"tasks", std::to_string(run.records().size())},
                              {"done", std::to_string(rows.size())}});
  fmt::print("{}: {} of {} tasks, digest {}\n", file.string(), rows.size(), run.records().size(),
             digest);
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
