#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/experiment_arguments.hpp"
#include "experiments/cli/output_directory.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/cli/shell_word.hpp"
#include "experiments/cli/slurm_script.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct SubmitArguments : ExperimentArguments {
  std::string partition;
  double bundle_seconds = 1800.0;
  std::size_t most_jobs = 1000;
  bool slurm = false;
  bool dry_run = false;
};

std::string file_words(const SubmitArguments& arguments) {
  return shell_word(std::filesystem::absolute(arguments.file).string()) +
         arguments.assignment_words();
}

// What a command prints on its first line. Throws InvalidInput where it fails.
std::string first_line_of(const std::string& command) {
  std::array<char, 256> line{};
  std::FILE* pipe = popen(command.c_str(), "r");
  MODCAL_REQUIRE(pipe != nullptr, "\"{}\" cannot be run", command);
  const bool read = std::fgets(line.data(), line.size(), pipe) != nullptr;
  const int status = pclose(pipe);
  MODCAL_REQUIRE(read && status == 0,
                 "\"{}\" failed: is this a machine that submits to Slurm? The scripts are written; "
                 "submit them where it is, or run shards by hand",
                 command);
  std::string text(line.data());
  return text.substr(0, text.find_first_of(";\n"));
}

void submit(const std::filesystem::path& folder) {
  const std::string array =
      first_line_of("sbatch --parsable " + shell_word((folder / "run.sh").string()));
  const std::string merge =
      first_line_of(fmt::format("sbatch --parsable --dependency=afterany:{} {}", array,
                                shell_word((folder / "merge.sh").string())));
  fmt::print("submitted array {} and merge {}\n", array, merge);
}

ExitCode submit_to_slurm(const SubmitArguments& arguments) {
  const auto loaded = load_and_print_mistakes(arguments.file, arguments.assignments);
  if (!loaded) return ExitCode::kInvalidInput;
  const std::filesystem::path out = std::filesystem::absolute(arguments.folder());
  const auto threads = static_cast<std::size_t>(std::max(1, arguments.threads));
  const RunSettings settings{
      .out = out,
      .command = fmt::format("modcal run {} --out {}", file_words(arguments), out.string())};
  const PilotRun pilot = run_pilot(*loaded, settings);
  const SlurmBundles bundles = slurm_bundles(pilot.pending, pilot.seconds_per_task, threads,
                                             arguments.bundle_seconds, arguments.most_jobs);
  const SlurmSettings slurm{.program = std::filesystem::read_symlink("/proc/self/exe").string(),
                            .file = file_words(arguments),
                            .out = out,
                            .partition = arguments.partition,
                            .threads = threads};
  const std::filesystem::path folder = out / "slurm";
  const OutputDirectory scripts(folder);
  scripts.write_text("run.sh", slurm_array_script(slurm, bundles));
  scripts.write_text("merge.sh", slurm_merge_script(slurm));
  fmt::print("{} tasks to do, {:.3g} s each (mean of {} that were run): {:.3g} core-hours\n",
             pilot.pending, pilot.seconds_per_task, pilot.run,
             static_cast<double>(pilot.pending) * pilot.seconds_per_task / 3600.0);
  fmt::print("{} jobs of {} threads, about {:.3g} s each; scripts in {}\n", bundles.count, threads,
             bundles.seconds, folder.string());
  if (!arguments.dry_run) submit(folder);
  return ExitCode::kOk;
}

void declare(CLI::App& command, SubmitArguments& arguments) {
  arguments.declare_file(command);
  command.add_flag("--slurm", arguments.slurm, "to Slurm, as an array of jobs")->required();
  arguments.declare_out(command, "nodes");
  command.add_option("--partition", arguments.partition, "partition of the cluster");
  declare_threads(command, arguments.threads, "threads of a job");
  command.add_option("--bundle-seconds", arguments.bundle_seconds, "length of a job to aim at")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--most-jobs", arguments.most_jobs,
                  "largest array; see MaxArraySize of the cluster")
      ->check(CLI::Range(1, 1000000));
  command.add_flag("--dry-run", arguments.dry_run, "write the scripts and submit nothing");
}

}  // namespace

void add_submit_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "submit",
              "Share a list of tasks out over a cluster and merge the results", declare,
              submit_to_slurm);
}

}  // namespace modcal
