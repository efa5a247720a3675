// modcal-mpi run FILE: a list of tasks over the ranks of an MPI job, one shard each; rank 0
// reports.
#include <mpi.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"

namespace modcal {
namespace {

// MPI_Finalize whichever way the program is left.
class MpiSession {
 public:
  MpiSession(int* argc, char*** argv) { MPI_Init(argc, argv); }
  ~MpiSession() { MPI_Finalize(); }
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  Shard shard() const {
    int rank = 0, size = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    return {static_cast<std::size_t>(rank) + 1, static_cast<std::size_t>(size)};
  }
  // The largest code of all ranks; waits for them.
  static ExitCode worst(ExitCode own) {
    int code = static_cast<int>(own);
    MPI_Allreduce(MPI_IN_PLACE, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    return static_cast<ExitCode>(code);
  }
};

ExitCode run_shard(const ExperimentArguments& arguments, const Shard& shard) {
  require_no_record(arguments.file);
  const LoadedExperiment loaded =
      load_experiment(arguments.file, arguments.assignments, arguments.means());
  if (shard.index == 1) {
    complain(complaints_of(loaded.document, loaded.mistakes));
  }
  if (loaded.has_errors()) return ExitCode::kInvalidInput;
  ExperimentArguments whole = arguments;
  whole.threads = 0;
  return run_one(loaded, {.out = arguments.folder(),
                          .threads = std::max(1, arguments.threads),
                          .command = whole.command(),
                          .shard = shard});
}

int main_of(int argc, char** argv) {
  if (!prepare_streams(argc, argv)) return static_cast<int>(ExitCode::kUsage);
  const MpiSession session(&argc, &argv);
  CLI::App app("modcal-mpi: runs a list of tasks over the ranks of an MPI job");
  ExperimentArguments arguments;
  CLI::App* run = app.add_subcommand("run", "Run an experiment");
  arguments.declare_file(*run);
  arguments.declare_out(*run, "ranks");
  declare_threads(*run, arguments.threads, "threads of a rank; default 1");
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return static_cast<int>(guarded([&] { return answer_of(app, error); }));
  }
  catch_interrupts();
  const Shard shard = session.shard();
  ExitCode code = MpiSession::worst(guarded([&] { return run_shard(arguments, shard); }));
  const bool complete = code == ExitCode::kOk || code == ExitCode::kSomeTasksFailed;
  if (complete && !shard.is_whole() && shard.index == 1) {
    code = guarded([&] { return report_stored_run(arguments.folder().string()); });
  }
  return static_cast<int>(MpiSession::worst(code));
}

}  // namespace
}  // namespace modcal

// An exception that nobody catches aborts, and the launcher ends the other ranks.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) { return modcal::main_of(argc, argv); }
