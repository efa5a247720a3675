#include "experiments/store/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

#include "experiments/store/task_key.hpp"
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

std::string content_of(const JournalRecord& record) {
  return fmt::format("{} {} {} {}", record.key, record.task, record.seconds, record.outcome);
}

// A line without its end, put into contents.
class LineReader {
 public:
  LineReader(const std::filesystem::path& file, JournalContents& contents)
      : file_(file), contents_(contents) {}

  void read(std::string_view line, std::size_t offset, bool has_end) {
    ++number_;
    if (line.empty() && has_end) return;
    const std::string_view content = line.substr(std::min(kChecksumDigits + 1, line.size()));
    const bool intact = line.size() > kChecksumDigits && line[kChecksumDigits] == ' ' &&
                        checksum_of(content) == line.substr(0, kChecksumDigits);
    if (!intact) return damaged(offset, has_end ? "does not match its checksum" : "is cut off");
    if (content.starts_with(kHeaderOfAnyVersion)) return require_version(content);
    read_record(content, offset);
  }

 private:
  void damaged(std::size_t offset, std::string reason) {
    contents_.damages.push_back({file_, number_, offset, std::move(reason)});
  }
  void require_version(std::string_view content) const {
    MODCAL_REQUIRE(content.starts_with(kHeader),
                   "{}: the journal has a format of another version (\"{}\"); read it with the "
                   "modcal that wrote it",
                   file_.string(), content);
  }
  void read_record(std::string_view content, std::size_t offset) {
    JournalRecord record;
    record.key = take_word(content);
    const bool good = read_number(take_word(content), record.task) &&
                      read_number(take_word(content), record.seconds);
    if (!good || record.key.empty() || content.empty()) return damaged(offset, "is no record");
    record.outcome = content;
    contents_.records.push_back(std::move(record));
  }

  const std::filesystem::path& file_;
  JournalContents& contents_;
  std::size_t number_ = 0;
};

std::string all_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  MODCAL_REQUIRE(stream.good(), "{}: the journal cannot be read: {}", file.string(),
                 std::strerror(errno));
  return std::move(text).str();
}

void read_into(const std::filesystem::path& file, JournalContents& contents) {
  if (std::filesystem::file_size(file) == 0) return;
  const std::string text = all_of(file);
  LineReader reader(file, contents);
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t found = text.find('\n', start);
    const bool has_end = found != std::string::npos;
    const std::size_t end = has_end ? found : text.size();
    reader.read(std::string_view(text).substr(start, end - start), start, has_end);
    start = end + 1;
  }
}

}  // namespace

std::string message_of(const JournalDamage& damage) {
  return fmt::format("{}: line {} at byte {} {}; its task will be run again", damage.file.string(),
                     damage.line, damage.offset, damage.reason);
}

JournalContents read_journal(const std::filesystem::path& file) {
  JournalContents contents;
  read_into(file, contents);
  return contents;
}

JournalContents read_journals(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.path().extension() == ".journal") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  JournalContents contents;
  for (const std::filesystem::path& file : files) read_into(file, contents);
  return contents;
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

void JournalWriter::append(const JournalRecord& record) { write_line(content_of(record)); }

void JournalWriter::write_line(std::string_view content) {
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
}

}  // namespace modcal
