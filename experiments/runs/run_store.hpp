// A part of a task list, for runs that share one list, and the lock that keeps two runs from
// working on the same tasks in the same folder.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <unordered_map>

#include "experiments/runs/journal.hpp"

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
  OpenFile folder_;
  OpenFile shard_;
};

/// Held while the results of a folder are made, a list's or a single run's: nobody else writes
/// there. Runs of shards share it.
class FolderLock {
 public:
  /// Throws InvalidInput where another run works in the folder.
  FolderLock(const std::filesystem::path& folder, const Shard& shard);

 private:
  OpenFile folder_;
};

/// Whether a run works in the folder; looks without touching.
bool is_running(const std::filesystem::path& folder);

// The store of one run: what is finished, and where more is put.

/// Where a record stands in the journals of a folder; a list keeps these, not the records.
struct RecordPlace {
  std::uint64_t offset = 0;
  std::uint32_t length = 0;  ///< 0: nowhere
  std::uint32_t file = 0;

  bool is_known() const { return length > 0; }
};

/// Reads single records of journals; safe to use from several threads.
class JournalReader {
 public:
  /// Number of the file in places. Throws InvalidInput where it cannot be opened.
  std::uint32_t add(const std::filesystem::path& file);
  /// Throws InvalidInput where the line cannot be read or is not what it was.
  JournalRecord read(const RecordPlace& place) const;
  /// "out/journal/shard-1-of-1.journal: line 17".
  std::string text_of(const RecordPlace& place) const;
  /// Throws LostOutput where a journal was deleted or moved since it was added.
  void require_in_place() const;

 private:
  std::vector<OpenFile> files_;
};

/// Finished tasks by their keys: 48 bytes or so a task, the outcomes stay in the journals.
class FinishedTasks {
 public:
  /// Scans the journals below a folder of results. `program` names what computes: the results of
  /// another program are not ours. Throws InvalidInput where a journal cannot be read.
  FinishedTasks(const std::filesystem::path& folder, std::string program);

  /// Key of a task with this fingerprint, under this program.
  std::string key_of(std::string_view fingerprint) const;
  /// Unknown: not finished when the journals were scanned.
  RecordPlace find(const std::string& key) const;
  JournalRecord read(const RecordPlace& place) const { return reader_->read(place); }
  /// Lines whose tasks were not done again, as far as is known.
  const std::vector<JournalDamage>& damages() const { return damages_; }
  JournalReader& reader() const { return *reader_; }
  /// Results that the journals hold, of whatever settings and programs.
  std::size_t size() const { return places_.size(); }

 private:
  // The 128 bits of a key.
  using Bits = std::array<std::uint64_t, 2>;
  struct BitsHash {
    std::size_t operator()(const Bits& bits) const { return bits[0]; }
  };
  static std::optional<Bits> bits_of(std::string_view key);

  std::string program_;
  std::unordered_map<Bits, RecordPlace, BitsHash> places_;
  std::vector<JournalDamage> damages_;
  std::unique_ptr<JournalReader> reader_ = std::make_unique<JournalReader>();
};

/// Opened by the run that computes. Safe to use from several threads.
class RunStore {
 public:
  /// Locks the folder, scans what is finished, opens this shard's journal. Throws InvalidInput
  /// where another run works there or the journal cannot be written.
  RunStore(const std::filesystem::path& folder, const Shard& shard, const std::string& program);

  const FinishedTasks& finished() const { return finished_; }
  RecordPlace append(const JournalRecord& record);
  /// Every task of the run is done: the damages that it found, in its own journal or, of a run of
  /// the whole list, in any, are history. Throws LostOutput where a journal was deleted or moved.
  void finish();

 private:
  std::filesystem::path journals_;
  std::string program_;
  bool is_whole_;
  RunLock lock_;
  FinishedTasks finished_;
  JournalWriter writer_;
  std::uint32_t own_file_;
};

/// Where the journals of a folder of results stand.
std::filesystem::path journal_folder(const std::filesystem::path& folder);

}  // namespace modcal
