#include "experiments/runs/run_store.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <set>
#include <system_error>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"

namespace modcal {
namespace {

// 0 where the text is not a whole positive number.
std::size_t count_of(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

constexpr std::string_view kFolderLock = "run.lock";

// A lock of the open file description: it does not vanish when another part of the program closes
// the same file, and it can be asked about without being taken.
struct flock whole_file(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

bool take(const OpenFile& file, short type) {
  struct flock lock = whole_file(type);
  return fcntl(file.descriptor(), F_OFD_SETLK, &lock) == 0;
}

std::string holder_of(const std::filesystem::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line.empty() ? std::string() : " (" + line + ")";
}

std::string own_name() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return fmt::format("process {} on {}\n", getpid(), host.data());
}

std::filesystem::path made_journal_folder(const std::filesystem::path& folder) {
  std::filesystem::path journals = journal_folder(folder);
  make_own_folder(journals);
  return journals;
}

}  // namespace

std::string Shard::text() const { return fmt::format("{}/{}", index, count); }

Shard parse_shard(std::string_view text) {
  const std::size_t slash = text.find('/');
  Shard shard{0, 0};
  if (slash != std::string_view::npos) {
    shard = {count_of(text.substr(0, slash)), count_of(text.substr(slash + 1))};
  }
  MODCAL_REQUIRE(shard.count >= 1 && shard.index >= 1 && shard.index <= shard.count,
                 "shard \"{}\" is not K/N with 1 <= K <= N, such as 2/7", text);
  return shard;
}

RunLock::RunLock(const std::filesystem::path& folder, const Shard& shard)
    : folder_(OpenFile::for_appending(folder / kFolderLock, "the lock")),
      shard_(OpenFile::for_appending(
          folder / fmt::format("shard-{}-of-{}.lock", shard.index, shard.count), "the lock")) {
  const bool taken = take(folder_, shard.is_whole() ? F_WRLCK : F_RDLCK) && take(shard_, F_WRLCK);
  MODCAL_REQUIRE(taken,
                 "another run works in {}{}; wait for it, stop it or choose another folder "
                 "with --out",
                 folder.parent_path().string(), holder_of(shard_.path()));
  const std::string name = own_name();
  if (ftruncate(shard_.descriptor(), 0) == 0) {
    // The name is a courtesy to whoever is refused: the lock holds without it.
    static_cast<void>(write(shard_.descriptor(), name.data(), name.size()) > 0);
  }
}

RunLock::~RunLock() {
  if (ftruncate(shard_.descriptor(), 0) != 0) errno = 0;
}

FolderLock::FolderLock(const std::filesystem::path& folder, const Shard& shard)
    : folder_(OpenFile::folder(folder, "the output folder")) {
  const int how = shard.is_whole() ? LOCK_EX : LOCK_SH;
  // Where a file system knows no locks of folders nobody is kept out.
  const bool taken = flock(folder_.descriptor(), how | LOCK_NB) == 0 || errno != EWOULDBLOCK;
  MODCAL_REQUIRE(taken,
                 "another run works in {}; wait for it, stop it or choose another folder with "
                 "--out",
                 folder.string());
}

bool is_running(const std::filesystem::path& folder) {
  const int descriptor =
      open((folder / kFolderLock).c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct flock lock = whole_file(F_WRLCK);
  const bool held = fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  close(descriptor);
  return held;
}

std::filesystem::path journal_folder(const std::filesystem::path& folder) {
  return folder / "journal";
}

std::uint32_t JournalReader::add(const std::filesystem::path& file) {
  files_.push_back(OpenFile::for_reading(file, "the journal"));
  return static_cast<std::uint32_t>(files_.size() - 1);
}

void JournalReader::require_in_place() const {
  for (const OpenFile& file : files_) file.require_in_place("the journal");
}

std::string JournalReader::text_of(const RecordPlace& place) const {
  const std::filesystem::path& file = files_.at(place.file).path();
  std::ifstream stream(file, std::ios::binary);
  std::size_t number = 0;
  std::string line;
  for (std::uint64_t start = 0; start <= place.offset && std::getline(stream, line); ++number) {
    start += line.size() + 1;
  }
  return fmt::format("{}: line {}", file.string(), number);
}

JournalRecord JournalReader::read(const RecordPlace& place) const {
  const OpenFile& file = files_.at(place.file);
  std::string line(place.length, '\0');
  std::size_t done = 0;
  while (done < line.size()) {
    const ssize_t count = pread(file.descriptor(), line.data() + done, line.size() - done,
                                static_cast<off_t>(place.offset + done));
    if (count < 0 && errno == EINTR) continue;
    MODCAL_REQUIRE(count > 0, "{}: the journal cannot be read: {}", file.path().string(),
                   count < 0 ? std::strerror(errno) : "it has become shorter");
    done += static_cast<std::size_t>(count);
  }
  return record_of_line(file.path(), line);
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
      program_(program),
      is_whole_(shard.is_whole()),
      lock_(journals_, shard),
      finished_(folder, program),
      writer_(
          journals_ / fmt::format("shard-{}-of-{}{}", shard.index, shard.count, kJournalExtension),
          program),
      own_file_(finished_.reader().add(writer_.file().path())) {}

void RunStore::finish() {
  finished_.reader().require_in_place();
  std::set<std::filesystem::path> damaged;
  for (const JournalDamage& damage : finished_.damages()) damaged.insert(damage.file);
  for (const std::filesystem::path& file : damaged) {
    try {
      if (file == writer_.file().path()) {
        writer_.declare_repaired();
      } else if (is_whole_) {
        JournalWriter(file, program_).declare_repaired();
      }
    } catch (const InvalidInput&) {
      // Of somebody else, or no space: the damage is named once more.
    }
  }
}

RecordPlace RunStore::append(const JournalRecord& record) {
  const JournalWriter::Place place = writer_.append(record);
  return {place.offset, static_cast<std::uint32_t>(place.length), own_file_};
}

}  // namespace modcal
