// Scripts that share a list of tasks out over a Slurm cluster.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace modcal {

/// How a list is cut into the jobs of an array.
struct SlurmBundles {
  std::size_t count = 1;        ///< jobs of the array, one shard each
  double seconds = 0.0;         ///< a job is expected to take, all its threads at work
  std::size_t time_limit = 10;  ///< to ask for [minutes]
};

/// Jobs of about `bundle_seconds`, at most `most`, no more than tasks where these are spread evenly
/// over as many shards, else of that number that spreads them best. `pending`: the tasks to do. The
/// limit asked for is three times what the longest is expected to take, and ten minutes at least: a
/// job that is cut loses nothing and is gone on with, but has to wait again.
SlurmBundles slurm_bundles(std::span<const std::size_t> pending, double seconds_per_task,
                           std::size_t threads, double bundle_seconds, std::size_t most);

struct SlurmSettings {
  std::string program;  ///< modcal
  std::string file;     ///< YAML, with its assignments as the command line has them
  std::filesystem::path out;
  std::string partition;  ///< empty: the cluster's default
  std::size_t threads = 1;
};

/// Array job: task K of N runs shard K/N.
std::string slurm_array_script(const SlurmSettings& settings, const SlurmBundles& bundles);
/// Job that merges and reports when the array has ended, however it did.
std::string slurm_merge_script(const SlurmSettings& settings);

}  // namespace modcal
