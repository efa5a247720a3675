// The store of one run: what is finished, and where more is put.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "experiments/store/journal.hpp"
#include "experiments/store/run_lock.hpp"
#include "experiments/store/shard.hpp"

namespace modcal {

/// Finished tasks by their keys.
class FinishedTasks {
 public:
  /// Reads the journals below a folder of results. `program` names what computes: the results of
  /// another program are not ours. Throws InvalidInput where a journal cannot be read.
  FinishedTasks(const std::filesystem::path& folder, std::string program);

  /// Key of a task with this fingerprint, under this program.
  std::string key_of(std::string_view fingerprint) const;
  /// Null: not finished.
  const JournalRecord* find(const std::string& key) const;
  const std::vector<JournalDamage>& damages() const { return damages_; }

 private:
  std::string program_;
  std::unordered_map<std::string, JournalRecord> records_;
  std::vector<JournalDamage> damages_;
};

/// Opened by the run that computes. Safe to use from several threads.
class RunStore {
 public:
  /// Locks the folder, reads what is finished, opens this shard's journal. Throws InvalidInput
  /// where another run works there or the journal cannot be written.
  RunStore(const std::filesystem::path& folder, const Shard& shard, const std::string& program);

  const FinishedTasks& finished() const { return finished_; }
  void append(const JournalRecord& record) { writer_.append(record); }

 private:
  std::filesystem::path journals_;
  RunLock lock_;
  FinishedTasks finished_;
  JournalWriter writer_;
};

/// Where the journals of a folder of results stand.
std::filesystem::path journal_folder(const std::filesystem::path& folder);

}  // namespace modcal
