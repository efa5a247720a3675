#include "experiments/runs/journal.hpp"

#include <sys/stat.h>
#include <unistd.h>
#define XXH_STATIC_LINKING_ONLY  // for a state that needs no allocation
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::string_view kHeader = "modcal-journal 1 ";
constexpr std::string_view kHeaderOfAnyVersion = "modcal-journal ";
constexpr std::size_t kChecksumDigits = 16;

std::string_view take_word(std::string_view& text) {
  const std::size_t blank = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, blank);
  text.remove_prefix(std::min(blank + 1, text.size()));
  return word;
}

template <typename Number>
bool read_number(std::string_view word, Number& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

bool parse_record(std::string_view content, JournalRecord& record) {
  record.key = take_word(content);
  const bool good = read_number(take_word(content), record.task) &&
                    read_number(take_word(content), record.seconds);
  record.outcome = content;
  return good && !record.key.empty() && !content.empty();
}

std::string content_of(const JournalRecord& record) {
  return fmt::format("{} {} {} {}", record.key, record.task, record.seconds, record.outcome);
}

// What stands behind the checksum of a line; nullopt where it does not match.
std::optional<std::string_view> intact_content(std::string_view line) {
  const std::string_view content = line.substr(std::min(kChecksumDigits + 1, line.size()));
  const bool intact = line.size() > kChecksumDigits && line[kChecksumDigits] == ' ' &&
                      checksum_of(content) == line.substr(0, kChecksumDigits);
  return intact ? std::optional(content) : std::nullopt;
}

std::string text_of(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

// A line without its end, handed on.
class LineReader {
 public:
  LineReader(const std::filesystem::path& file, const TakeRecord& take,
             std::vector<JournalDamage>& damages)
      : file_(file), take_(take), damages_(damages), others_(damages.size()) {}

  void read(std::string_view line, std::size_t offset, bool has_end) {
    ++number_;
    if (line.empty() && has_end) return;
    const std::optional<std::string_view> content = intact_content(line);
    if (!content) return damaged(offset, has_end ? "does not match its checksum" : "is cut off");
    if (content->starts_with(kHeaderOfAnyVersion)) {
      require_version(*content);
      return damages_.resize(others_);  // what was damaged before is done again
    }
    if (!parse_record(*content, record_)) return damaged(offset, "is no record");
    take_(record_, offset, line.size());
  }

 private:
  void damaged(std::size_t offset, std::string reason) {
    damages_.push_back({file_, number_, offset, std::move(reason)});
  }
  void require_version(std::string_view content) const {
    MODCAL_REQUIRE(content.starts_with(kHeader),
                   "{}: the journal has a format of another version (\"{}\"); read it with the "
                   "modcal that wrote it",
                   file_.string(), content);
  }

  const std::filesystem::path& file_;
  const TakeRecord& take_;
  std::vector<JournalDamage>& damages_;
  std::size_t others_;  // of other files
  JournalRecord record_;
  std::size_t number_ = 0;
};

}  // namespace

std::string message_of(const JournalDamage& damage) {
  return fmt::format("{}: line {} at byte {} {}; its task will be run again", damage.file.string(),
                     damage.line, damage.offset, damage.reason);
}

void scan_journal(const std::filesystem::path& file, const TakeRecord& take,
                  std::vector<JournalDamage>& damages) {
  require_regular_file(file);
  std::ifstream stream(file, std::ios::binary);
  MODCAL_REQUIRE(stream.good(), "{}: the journal cannot be read: {}", file.string(),
                 std::strerror(errno));
  LineReader reader(file, take, damages);
  std::string line;
  for (std::size_t start = 0; std::getline(stream, line); start += line.size() + 1) {
    // A last line without its end sets the end of the file.
    reader.read(line, start, !stream.eof());
  }
  MODCAL_REQUIRE(!stream.bad(), "{}: the journal cannot be read: {}", file.string(),
                 std::strerror(errno));
}

JournalRecord record_of_line(const std::filesystem::path& file, std::string_view line) {
  JournalRecord record;
  const std::optional<std::string_view> content = intact_content(line);
  MODCAL_REQUIRE(content && parse_record(*content, record),
                 "{}: a line has changed while it was in use; run the command again",
                 file.string());
  return record;
}

std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() == kJournalExtension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

JournalWriter::JournalWriter(const std::filesystem::path& file, std::string program)
    : file_(OpenFile::for_appending(file, "the journal")), program_(std::move(program)) {
  const off_t size = lseek(file_.descriptor(), 0, SEEK_END);
  char last = '\n';
  if (size > 0 && pread(file_.descriptor(), &last, 1, size - 1) == 1 && last != '\n') {
    // Ends what a killed run left, so that the next line stands for itself.
    MODCAL_REQUIRE(write(file_.descriptor(), "\n", 1) == 1, "{}: the journal cannot be written: {}",
                   file.string(), std::strerror(errno));
  }
  if (size <= 0) declare_repaired();
}

JournalWriter::~JournalWriter() { fdatasync(file_.descriptor()); }

JournalWriter::Place JournalWriter::append(const JournalRecord& record) {
  const Place place = write_line(content_of(record));
  file_.require_in_place("the journal");
  return place;
}

void JournalWriter::declare_repaired() { write_line(std::string(kHeader) + program_); }

JournalWriter::Place JournalWriter::write_line(std::string_view content) {
  const std::string line = fmt::format("{} {}\n", checksum_of(content), content);
  const std::lock_guard lock(mutex_);
  const int descriptor = file_.descriptor();
  const off_t start = lseek(descriptor, 0, SEEK_END);
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t count = write(descriptor, line.data() + written, line.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const std::string reason = std::strerror(errno);
      if (start >= 0) static_cast<void>(ftruncate(descriptor, start) == 0);
      throw InvalidInput(fmt::format(
          "{}: the journal cannot be written: {}; make room and run the same command again, what "
          "the journal holds is not repeated",
          file_.path().string(), reason));
    }
    written += static_cast<std::size_t>(count);
  }
  return {static_cast<std::uint64_t>(start), line.size() - 1};
}

std::string digest_of(std::string_view text) {
  return text_of(XXH3_128bits(text.data(), text.size()));
}

std::string digest_of_file(const std::filesystem::path& file) {
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> block(1 << 18);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())).gcount() > 0) {
    XXH3_128bits_update(&state, block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  MODCAL_REQUIRE(stream.eof() && !stream.bad(), "{}: cannot be read", file.string());
  return text_of(XXH3_128bits_digest(&state));
}

std::string input_digest(const std::filesystem::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return "missing";
  // Who sets the time of the content back changes that of the file.
  const std::string touched = fmt::format(
      "{} {} {} {} {} {} {}", status.st_dev, status.st_ino, status.st_size, status.st_mtim.tv_sec,
      status.st_mtim.tv_nsec, status.st_ctim.tv_sec, status.st_ctim.tv_nsec);
  static std::mutex mutex;
  static std::map<std::string, std::string> known;
  const std::lock_guard lock(mutex);
  std::string& digest = known[touched];
  if (digest.empty()) digest = digest_of_file(file);
  return digest;
}

std::string checksum_of(std::string_view text) {
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace modcal
