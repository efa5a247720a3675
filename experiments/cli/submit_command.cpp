#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/cli/output_directory.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/cli/shell_word.hpp"
#include "experiments/cli/slurm_script.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct SubmitArguments {
  std::string file;
  std::string out;
  std::vector<std::string> assignments;
  std::string partition;
  std::size_t threads = 1;
  double bundle_seconds = 1800.0;
  std::size_t most_jobs = 1000;
  bool slurm = false;
  bool dry_run = false;
};

std::string file_words(const SubmitArguments& arguments) {
  std::string words = shell_word(std::filesystem::absolute(arguments.file).string());
  for (const std::string& assignment : arguments.assignments) {
    words += " --set " + shell_word(assignment);
  }
  return words;
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
  const LoadedExperiment loaded = load_experiment(arguments.file, arguments.assignments);
  fmt::print(stderr, "{}", colored(format_mistakes(loaded.document, loaded.mistakes)));
  if (loaded.has_errors()) return ExitCode::kInvalidInput;
  const std::filesystem::path out = std::filesystem::absolute(
      arguments.out.empty()
          ? std::filesystem::path("out") / std::filesystem::path(arguments.file).stem()
          : std::filesystem::path(arguments.out));
  const RunSettings settings{
      .out = out,
      .command = fmt::format("modcal run {} --out {}", file_words(arguments), out.string())};
  const PilotRun pilot = run_pilot(loaded, settings);
  const SlurmBundles bundles =
      slurm_bundles(pilot.pending, pilot.seconds_per_task, arguments.threads,
                    arguments.bundle_seconds, arguments.most_jobs);
  const SlurmSettings slurm{.program = std::filesystem::read_symlink("/proc/self/exe").string(),
                            .file = file_words(arguments),
                            .out = out,
                            .partition = arguments.partition,
                            .threads = arguments.threads};
  const std::filesystem::path folder = out / "slurm";
  const OutputDirectory scripts(folder);
  scripts.write_text("run.sh", slurm_array_script(slurm, bundles));
  scripts.write_text("merge.sh", slurm_merge_script(slurm));
  fmt::print("{} tasks to do, {:.3g} s each (mean of {} that were run): {:.3g} core-hours\n",
             pilot.pending, pilot.seconds_per_task, pilot.run,
             static_cast<double>(pilot.pending) * pilot.seconds_per_task / 3600.0);
  fmt::print("{} jobs of {} threads, about {:.3g} s each; scripts in {}\n", bundles.count,
             arguments.threads, bundles.seconds, folder.string());
  if (!arguments.dry_run) submit(folder);
  return ExitCode::kOk;
}

}  // namespace

void add_submit_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand(
      "submit", "Share a list of tasks out over a cluster and merge the results");
  auto arguments = std::make_shared<SubmitArguments>();
  command->add_option("file", arguments->file, "YAML file")->required();
  command->add_flag("--slurm", arguments->slurm, "to Slurm, as an array of jobs")->required();
  command->add_option("--out", arguments->out,
                      "folder of the results, seen by all nodes; default out/<name of the file>");
  command->add_option("--set", arguments->assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
  command->add_option("--partition", arguments->partition, "partition of the cluster");
  command->add_option("--threads", arguments->threads, "threads of a job")
      ->check(CLI::Range(1, 4096));
  command->add_option("--bundle-seconds", arguments->bundle_seconds, "length of a job to aim at")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--most-jobs", arguments->most_jobs,
                   "largest array; see MaxArraySize of the cluster")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--dry-run", arguments->dry_run, "write the scripts and submit nothing");
  command->callback([=] { chosen([=] { return submit_to_slurm(*arguments); }); });
}

}  // namespace modcal
