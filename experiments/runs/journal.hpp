// Append-only journal of finished tasks: what a killed run leaves is what it had finished.
//
// One line a task, "checksum key task seconds outcome", where the checksum covers the rest of the
// line. Every line stands for itself: a damaged one costs itself and nothing else.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/base/files.hpp"

namespace modcal {

/// One finished task.
struct JournalRecord {
  std::string key;         ///< equal for tasks with equal outcomes, 32 hexadecimal digits
  std::uint64_t task = 0;  ///< number in the list it was run from
  double seconds = 0.0;    ///< time it took
  std::string outcome;     ///< JSON on one line
};

/// A line that cannot be trusted.
struct JournalDamage {
  std::filesystem::path file;
  std::size_t line = 0;    ///< counted from 1
  std::size_t offset = 0;  ///< of its first byte
  std::string reason;
};

/// "out/journal/shard-1-of-1: line 17 at byte 2345 is cut off; its task will be run again"
std::string message_of(const JournalDamage& damage);

/// Calls `take` for every record of a journal with the place of its line's first byte and the
/// line's length; holds one line at a time. A damage that JournalWriter::declare_repaired() has
/// followed is none. Throws InvalidInput where the journal cannot be read or has another version's
/// format.
using TakeRecord =
    std::function<void(const JournalRecord& record, std::uint64_t offset, std::size_t length)>;
void scan_journal(const std::filesystem::path& file, const TakeRecord& take,
                  std::vector<JournalDamage>& damages);

/// The record of a line that scan_journal() or append() has placed. Throws InvalidInput where the
/// line is no longer what it was.
JournalRecord record_of_line(const std::filesystem::path& file, std::string_view line);

inline constexpr std::string_view kJournalExtension = ".journal";

/// Journals of a folder by name; none where there is no such folder.
std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder);

/// Appends records to one journal; several threads may use one writer, one process one journal.
class JournalWriter {
 public:
  /// Opens or makes the file; a line that a killed run left unfinished is ended. `program` is
  /// written down as the maker. Throws InvalidInput where the file cannot be written, or is one
  /// that somebody else may have put there (OpenFile).
  JournalWriter(const std::filesystem::path& file, std::string program);
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// Where a line stands, without its end.
  struct Place {
    std::uint64_t offset = 0;
    std::size_t length = 0;
  };
  /// Hands the record to the system in one write: it outlives the process from then on. Throws
  /// InvalidInput where that fails (no space), and the journal ends with the record before;
  /// LostOutput where the journal was deleted or moved.
  Place append(const JournalRecord& record);
  /// Writes down that the tasks of damaged lines before were done again.
  void declare_repaired();
  const OpenFile& file() const { return file_; }

 private:
  Place write_line(std::string_view content);

  OpenFile file_;
  std::string program_;
  std::mutex mutex_;
};

// Names of tasks and digests of results.

/// 32 hexadecimal digits (XXH3, 128 bits) that are equal for equal texts.
std::string digest_of(std::string_view text);

/// The same of a file's content. Throws InvalidInput where it cannot be read.
std::string digest_of_file(const std::filesystem::path& file);

/// digest_of_file() of an input, read once for as long as nothing touches the file; "missing" where
/// there is none.
std::string input_digest(const std::filesystem::path& file);

/// 16 hexadecimal digits (XXH3, 64 bits) that tell a damaged line.
std::string checksum_of(std::string_view text);

}  // namespace modcal
