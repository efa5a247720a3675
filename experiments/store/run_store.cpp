#include "experiments/store/run_store.hpp"

#include <fmt/format.h>

#include <system_error>

#include "experiments/store/task_key.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::filesystem::path made_journal_folder(const std::filesystem::path& folder) {
  std::filesystem::path journals = journal_folder(folder);
  std::error_code error;
  std::filesystem::create_directories(journals, error);
  MODCAL_REQUIRE(!error, "the folder {} cannot be made: {}; choose another one with --out",
                 journals.string(), error.message());
  return journals;
}

}  // namespace

std::filesystem::path journal_folder(const std::filesystem::path& folder) {
  return folder / "journal";
}

FinishedTasks::FinishedTasks(const std::filesystem::path& folder, std::string program)
    : program_(std::move(program)) {
  JournalContents contents = read_journals(journal_folder(folder));
  damages_ = std::move(contents.damages);
  for (JournalRecord& record : contents.records) {
    std::string key = record.key;
    records_.insert_or_assign(std::move(key), std::move(record));
  }
}

std::string FinishedTasks::key_of(std::string_view fingerprint) const {
  return digest_of(fmt::format("{}\n{}", program_, fingerprint));
}

const JournalRecord* FinishedTasks::find(const std::string& key) const {
  const auto found = records_.find(key);
  return found == records_.end() ? nullptr : &found->second;
}

RunStore::RunStore(const std::filesystem::path& folder, const Shard& shard,
                   const std::string& program)
    : journals_(made_journal_folder(folder)),
      lock_(journals_, shard),
      finished_(folder, program),
      writer_(journals_ / fmt::format("shard-{}-of-{}.journal", shard.index, shard.count),
              program) {}

}  // namespace modcal
