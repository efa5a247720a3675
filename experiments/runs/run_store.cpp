#include "experiments/runs/run_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>

#include "experiments/runs/task_key.hpp"
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

JournalReader::~JournalReader() {
  for (const auto& [file, descriptor] : files_) close(descriptor);
}

std::uint32_t JournalReader::add(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  MODCAL_REQUIRE(descriptor >= 0, "{}: the journal cannot be read: {}", file.string(),
                 std::strerror(errno));
  files_.emplace_back(file, descriptor);
  return static_cast<std::uint32_t>(files_.size() - 1);
}

JournalRecord JournalReader::read(const RecordPlace& place) const {
  const auto& [file, descriptor] = files_.at(place.file);
  std::string line(place.length, '\0');
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t count = pread(descriptor, line.data() + done, line.size() - done,
                                static_cast<off_t>(place.offset + done));
    if (count < 0 && errno == EINTR) continue;
    MODCAL_REQUIRE(count > 0, "{}: the journal cannot be read: {}", file.string(),
                   count < 0 ? std::strerror(errno) : "it has become shorter");
    done += static_cast<std::size_t>(count);
  }
  return record_of_line(file, line);
}

FinishedTasks::FinishedTasks(const std::filesystem::path& folder, std::string program)
    : program_(std::move(program)) {
  for (const std::filesystem::path& file : journals_in(journal_folder(folder))) {
    const std::uint32_t number = reader_->add(file);
    scan_journal(
        file,
        [&](const JournalRecord& record, std::uint64_t offset, std::size_t length) {
          if (const auto bits = bits_of(record.key)) {
            places_[*bits] = {offset, static_cast<std::uint32_t>(length), number};
          }
        },
        damages_);
  }
}

std::optional<FinishedTasks::Bits> FinishedTasks::bits_of(std::string_view key) {
  Bits bits{};
  if (key.size() != 32) return std::nullopt;
  for (std::size_t half = 0; half < 2; ++half) {
    const char* start = key.data() + 16 * half;
    const auto [end, error] = std::from_chars(start, start + 16, bits[half], 16);
    if (error != std::errc() || end != start + 16) return std::nullopt;
  }
  return bits;
}

std::string FinishedTasks::key_of(std::string_view fingerprint) const {
  return digest_of(fmt::format("{}\n{}", program_, fingerprint));
}

RecordPlace FinishedTasks::find(const std::string& key) const {
  const auto bits = bits_of(key);
  if (!bits) return {};
  const auto found = places_.find(*bits);
  return found == places_.end() ? RecordPlace{} : found->second;
}

RunStore::RunStore(const std::filesystem::path& folder, const Shard& shard,
                   const std::string& program)
    : journals_(made_journal_folder(folder)),
      lock_(journals_, shard),
      finished_(folder, program),
      writer_(journals_ / fmt::format("shard-{}-of-{}.journal", shard.index, shard.count), program),
      own_file_(finished_.reader().add(writer_.file())) {}

RecordPlace RunStore::append(const JournalRecord& record) {
  const JournalWriter::Place place = writer_.append(record);
  return {place.offset, static_cast<std::uint32_t>(place.length), own_file_};
}

}  // namespace modcal
