#include "experiments/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

#include "experiments/runs/task_experiment.hpp"
#include "libsim/records/record_file.hpp"

namespace modcal {
namespace {

double signals_of(const OutputRequest& outputs) {
  const bool wanted[] = {outputs.displacement, outputs.velocity, outputs.force,
                         outputs.left_reaction, outputs.right_reaction};
  return static_cast<double>(std::count(std::begin(wanted), std::end(wanted), true));
}

double tasks_at_a_time(const Experiment& experiment, std::size_t threads) {
  const auto* list = dynamic_cast<const TaskExperiment*>(&experiment);
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  return static_cast<double>(std::min(threads, list != nullptr ? list->task_count() : 1));
}

}  // namespace

double memory_needed(const Experiment& experiment, std::size_t threads) {
  const auto planned = experiment.planned_simulations();
  if (!planned) return 0.0;
  double kept = 0.0, work = 0.0;
  const auto add = [&](const PlannedSimulations& one) {
    const double samples = one.truth.scene.duration * one.sample_rate;
    const double all = static_cast<double>(one.count) * signals_of(one.outputs);
    if (one.are_kept) kept += all * samples;
    work = std::max(work, one.numbers_per_sample * samples);
  };
  add(*planned);
  for (const PlannedSimulations& other : planned->others) add(other);
  return sizeof(double) * (kept + tasks_at_a_time(experiment, threads) * work);
}

double memory_of_files(const Experiment& experiment, const std::filesystem::path& folder,
                       std::size_t threads) {
  double bytes = 0.0;
  for (const FileRead& file : experiment.files_read()) {
    bytes += sizeof(double) * file.numbers * tasks_at_a_time(experiment, threads);
    if (file.format.empty()) continue;
    const auto size = size_of_record(folder / file.name, file.format);
    if (!size) continue;
    // Not a number where the file does not tell its rate.
    const double in_band = size->frames / size->sample_rate * file.numbers_per_second;
    bytes += size->bytes_to_read(std::min(size->channels, file.channels)) +
             sizeof(double) * (size->frames * file.numbers_per_sample +
                               (std::isfinite(in_band) ? in_band : 0.0));
  }
  return bytes;
}

double machine_memory() {
  double bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  // A container's share, and what the shell allows.
  for (const char* file :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    double share = 0.0;
    if (std::ifstream(file) >> share && share > 0.0) bytes = std::min(bytes, share);
  }
  for (const auto resource : {RLIMIT_AS, RLIMIT_DATA}) {
    struct rlimit limit {};
    if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) continue;
    bytes = std::min(bytes, static_cast<double>(limit.rlim_cur));
  }
  return bytes;
}

std::string bytes_text(double bytes) {
  static constexpr std::pair<double, const char*> kUnits[] = {
      {1e12, "TB"}, {1e9, "GB"}, {1e6, "MB"}, {1e3, "kB"}};
  for (const auto& [size, unit] : kUnits) {
    if (bytes >= size) return fmt::format("{:.3g} {}", bytes / size, unit);
  }
  return fmt::format("{:.0f} B", bytes);
}

}  // namespace modcal
