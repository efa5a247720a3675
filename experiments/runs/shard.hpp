// A part of a task list, for runs that share one list, and the lock that keeps two runs from
// working on the same tasks in the same folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace modcal {

/// Part K of N: the tasks i with i mod N = K − 1. A Slurm array, MPI ranks and a laptop all use it.
struct Shard {
  std::size_t index = 1;  ///< K, 1 ≤ K ≤ N
  std::size_t count = 1;  ///< N

  bool is_whole() const { return count == 1; }
  bool holds(std::size_t task) const { return task % count == index - 1; }
  std::size_t size(std::size_t tasks) const { return (tasks + count - index) / count; }
  /// "2/7", as on the command line.
  std::string text() const;
};

/// Reads "K/N". Throws InvalidInput for anything else and for K outside 1…N.
Shard parse_shard(std::string_view text);

/// Held while a run works in a folder; the system lets go of it when the process ends, however it
/// ends. Runs of different shards share a folder, a run of the whole list has it for itself.
class RunLock {
 public:
  /// Throws InvalidInput where another run works in the folder, naming it.
  RunLock(const std::filesystem::path& folder, const Shard& shard);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  int folder_descriptor_ = -1;
  int shard_descriptor_ = -1;
};

/// Whether a run works in the folder; looks without touching.
bool is_running(const std::filesystem::path& folder);

}  // namespace modcal
