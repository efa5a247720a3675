#include "experiments/runs/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>

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

// A line without its end, handed on.
class LineReader {
 public:
  LineReader(const std::filesystem::path& file, const TakeRecord& take,
             std::vector<JournalDamage>& damages)
      : file_(file), take_(take), damages_(damages) {}

  void read(std::string_view line, std::size_t offset, bool has_end) {
    ++number_;
    if (line.empty() && has_end) return;
    const std::optional<std::string_view> content = intact_content(line);
    if (!content) return damaged(offset, has_end ? "does not match its checksum" : "is cut off");
    if (content->starts_with(kHeaderOfAnyVersion)) return require_version(*content);
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
  // A device would never end.
  std::error_code error;
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error)) {
    return;
  }
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
    if (entry.path().extension() == ".journal") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

JournalWriter::JournalWriter(std::filesystem::path file, std::string_view program)
    : file_(std::move(file)) {
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  MODCAL_REQUIRE(descriptor_ >= 0, "{}: the journal cannot be opened: {}", file_.string(),
                 std::strerror(errno));
  const off_t size = lseek(descriptor_, 0, SEEK_END);
  char last = '\n';
  if (size > 0 && pread(descriptor_, &last, 1, size - 1) == 1 && last != '\n') {
    // Ends what a killed run left, so that the next line stands for itself.
    MODCAL_REQUIRE(write(descriptor_, "\n", 1) == 1, "{}: the journal cannot be written: {}",
                   file_.string(), std::strerror(errno));
  }
  if (size <= 0) write_line(std::string(kHeader) + std::string(program));
}

JournalWriter::~JournalWriter() {
  fdatasync(descriptor_);
  close(descriptor_);
}

JournalWriter::Place JournalWriter::append(const JournalRecord& record) {
  return write_line(content_of(record));
}

JournalWriter::Place JournalWriter::write_line(std::string_view content) {
  const std::string line = fmt::format("{} {}\n", checksum_of(content), content);
  const std::lock_guard lock(mutex_);
  const off_t start = lseek(descriptor_, 0, SEEK_END);
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t count = write(descriptor_, line.data() + written, line.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const std::string reason = std::strerror(errno);
      if (start >= 0) static_cast<void>(ftruncate(descriptor_, start) == 0);
      throw InvalidInput(fmt::format(
          "{}: the journal cannot be written: {}; make room and run the same command again, what "
          "the journal holds is not repeated",
          file_.string(), reason));
    }
    written += static_cast<std::size_t>(count);
  }
  return {static_cast<std::uint64_t>(start), line.size() - 1};
}

std::string digest_of(std::string_view text) {
  const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string checksum_of(std::string_view text) {
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

}  // namespace modcal
