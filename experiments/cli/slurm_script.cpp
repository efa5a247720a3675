#include "experiments/cli/slurm_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiments/cli/shell_word.hpp"

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
  option("output", (settings.out / "slurm" / (std::string(name) + "-%A_%a.log")).string());
  // A job that a node's failure ends is put back: it goes on where its journal ends.
  option("requeue", "");
  text.erase(text.size() - 2, 1);
  if (!settings.partition.empty()) option("partition", settings.partition);
  return text;
}

}  // namespace

SlurmBundles slurm_bundles(std::size_t tasks, double seconds_per_task, std::size_t threads,
                           double bundle_seconds, std::size_t most) {
  const double core_seconds = static_cast<double>(tasks) * seconds_per_task;
  const double seconds = core_seconds / static_cast<double>(threads);
  const double wanted = std::ceil(seconds / bundle_seconds);
  const auto limit = static_cast<double>(std::max<std::size_t>(1, std::min(tasks, most)));
  SlurmBundles bundles;
  bundles.count = static_cast<std::size_t>(std::clamp(wanted, 1.0, limit));
  bundles.seconds = seconds / static_cast<double>(bundles.count);
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

}  // namespace modcal
