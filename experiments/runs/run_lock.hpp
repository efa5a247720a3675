// Keeps two runs from working on the same tasks in the same folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "experiments/runs/shard.hpp"

namespace modcal {

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
