#include "experiments/cli/slurm.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "experiments/cli/output_directory.hpp"
#include "experiments/cli/runner.hpp"

namespace modcal {
namespace {

std::string head(const SlurmSettings& settings, std::string_view name, std::size_t threads,
                 std::size_t minutes) {
  std::string text = "#!/bin/sh\n";
  const auto option = [&text](std::string_view key, const std::string& value) {
    text += fmt::format("#SBATCH --{}={}\n", key, value);
  };
  option("job-name", fmt::format("modcal-{}", name));
  option("cpus-per-task", std::to_string(threads));
  option("time", std::to_string(minutes));
  option("output", (settings.out / kSlurmFolder / (std::string(name) + "-%A_%a.log")).string());
  // A job that a node's failure ends is put back: it goes on where its journal ends.
  option("requeue", "");
  text.erase(text.size() - 2, 1);
  if (!settings.partition.empty()) option("partition", settings.partition);
  return text;
}

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
  add_to_json("array", array);
  add_to_json("merge", merge);
  say("submitted array {} and merge {}\n", array, merge);
}

ExitCode submit_to_slurm(const SubmitArguments& arguments) {
  const auto loaded =
      load_and_print_mistakes(arguments.file, arguments.assignments, arguments.means());
  if (!loaded) return ExitCode::kInvalidInput;
  const std::filesystem::path out = std::filesystem::absolute(arguments.folder());
  const auto threads = static_cast<std::size_t>(std::max(1, arguments.threads));
  const RunSettings settings{.out = out,
                             .command = fmt::format("modcal run {} --out {}", file_words(arguments),
                                                    shell_word(out.string()))};
  OutputDirectory(out).require_own({kSlurmScripts.begin(), kSlurmScripts.end()});
  const PilotRun pilot = run_pilot(*loaded, settings);
  const SlurmBundles bundles = slurm_bundles(pilot.pending, pilot.seconds_per_task, threads,
                                             arguments.bundle_seconds, arguments.most_jobs);
  const SlurmSettings slurm{.program = std::filesystem::read_symlink("/proc/self/exe").string(),
                            .file = file_words(arguments),
                            .out = out,
                            .partition = arguments.partition,
                            .threads = threads};
  const std::filesystem::path folder = out / kSlurmFolder;
  const OutputDirectory scripts(folder);
  OutputDirectory(out).announce({kSlurmScripts.begin(), kSlurmScripts.end()});
  scripts.write_text("run.sh", slurm_array_script(slurm, bundles));
  scripts.write_text("merge.sh", slurm_merge_script(slurm));
  add_to_json("tasks", pilot.pending.size());
  add_to_json("jobs", bundles.count);
  add_to_json("scripts", folder.string());
  say("{} tasks to do, {:.3g} s each (mean of {} that were run): {:.3g} core-hours\n",
      pilot.pending.size(), pilot.seconds_per_task, pilot.run,
      static_cast<double>(pilot.pending.size()) * pilot.seconds_per_task / 3600.0);
  say("{} jobs of {} threads, about {:.3g} s each; scripts in {}\n", bundles.count, threads,
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
      ->check([](const std::string& text) {
        return std::strtod(text.c_str(), nullptr) > 0.0
                   ? std::string()
                   : fmt::format("\"{}\" is no length of a job: write seconds > 0", text);
      });
  command
      .add_option("--most-jobs", arguments.most_jobs,
                  "largest array; see MaxArraySize of the cluster")
      ->check(CLI::Range(1, 1000000));
  command.add_flag("--dry-run", arguments.dry_run, "write the scripts and submit nothing");
}

// Tasks of the longest of so many shards.
std::size_t largest_shard(std::span<const std::size_t> pending, std::size_t count) {
  std::vector<std::size_t> loads(count, 0);
  for (const std::size_t task : pending) ++loads[task % count];
  return *std::ranges::max_element(loads);
}

}  // namespace

SlurmBundles slurm_bundles(std::span<const std::size_t> pending, double seconds_per_task,
                           std::size_t threads, double bundle_seconds, std::size_t most) {
  const double task_seconds = seconds_per_task / static_cast<double>(threads);
  const double wanted =
      std::ceil(static_cast<double>(pending.size()) * task_seconds / bundle_seconds);
  const auto limit = static_cast<double>(std::max<std::size_t>(1, std::min(pending.size(), most)));
  SlurmBundles bundles{.count = static_cast<std::size_t>(std::clamp(wanted, 1.0, limit))};
  // Where other shards did a part of the list, what is left may be all in one of as many.
  const std::size_t even = pending.size() / bundles.count + 1;
  const std::size_t last = std::min(most, 2 * bundles.count + 7);
  std::size_t load = largest_shard(pending, bundles.count);
  for (std::size_t count = bundles.count + 1; count <= last && 4 * load > 5 * even; ++count) {
    const std::size_t other = largest_shard(pending, count);
    if (other < load) bundles.count = count, load = other;
  }
  bundles.seconds = static_cast<double>(load) * task_seconds;
  const double minutes = std::ceil(3.0 * bundles.seconds / 60.0);
  bundles.time_limit = std::max<std::size_t>(10, static_cast<std::size_t>(minutes));
  return bundles;
}

std::string slurm_array_script(const SlurmSettings& settings, const SlurmBundles& bundles) {
  std::string text = head(settings, "run", settings.threads, bundles.time_limit);
  text += fmt::format("#SBATCH --array=1-{}\n", bundles.count);
  text += fmt::format("exec {} run {} --out {} --threads {} --shard \"$SLURM_ARRAY_TASK_ID\"/{}\n",
                      shell_word(settings.program), settings.file,
                      shell_word(settings.out.string()), settings.threads, bundles.count);
  return text;
}

std::string slurm_merge_script(const SlurmSettings& settings) {
  const std::string program = shell_word(settings.program);
  const std::string out = shell_word(settings.out.string());
  return head(settings, "merge", 1, 60) +
         fmt::format("{} merge {} && exec {} report {}\n", program, out, program, out);
}

void add_submit_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "submit",
              "Share a list of tasks out over a cluster and merge the results", declare,
              submit_to_slurm);
}

}  // namespace modcal
