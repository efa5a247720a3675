#include "libsim/base/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <random>
#include <system_error>
#include <utility>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kPart = ".part";

// Of the files that are being written, some of them at least: the handler of a signal may neither
// lock nor allocate.
std::array<std::atomic<const char*>, 64> part_names;

const char* name_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISLNK(mode)) return "a link";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// Somebody else's file, moved or linked here, would be written to by whoever runs.
void require_own(const struct stat& status, const fs::path& file, std::string_view what) {
  MODCAL_REQUIRE(status.st_nlink <= 1,
                 "{}: {} has a second name elsewhere (a hard link), where it would change, too: "
                 "put a copy in its place",
                 file.string(), what);
  struct stat folder {};
  // 65534 is what servers and containers that map users make of ours.
  const bool known_owner =
      status.st_uid == geteuid() || status.st_uid == 65534 ||
      (stat(folder_of(file).c_str(), &folder) == 0 && folder.st_uid == status.st_uid);
  MODCAL_REQUIRE(known_owner,
                 "{}: {} belongs to somebody else (user {}), who does not own the folder either: "
                 "put a copy in its place",
                 file.string(), what, status.st_uid);
}

// The byte that says that somebody writes; SQLite's own locks are elsewhere.
struct flock first_byte(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_len = 1;
  return lock;
}

// Not there before, whatever its name leads to.
int make_new_file(const fs::path& file) {
  return open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

fs::path with_random_end(fs::path path, std::string_view end) {
  std::random_device random;
  path += fmt::format(".{:08x}{}", random(), end);
  return path;
}

// NAME.xxxxxxxx.part, or NAME.PID.part as earlier versions wrote it; what gnuplot draws to has
// another name.
bool is_part_name(const fs::path& file) {
  const std::string end = file.stem().extension().string();
  return file.extension() == kPart && end.size() > 1 &&
         end.find_first_not_of("0123456789abcdef", 1) == std::string::npos;
}

bool is_abandoned(const fs::path& part) {
  const int descriptor = open(part.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct flock lock = first_byte(F_WRLCK);
  struct stat status {};
  // Younger ones may be about to be locked.
  const bool free = fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type == F_UNLCK &&
                    fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
                    status.st_mtime + 1 < time(nullptr);
  close(descriptor);
  return free;
}

}  // namespace

void require_regular_file(const fs::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return;
  throw_invalid_input("{}: this is {}, not a file", file.string(), name_of(status.st_mode));
}

std::string content_of_file(const fs::path& file) {
  require_regular_file(file);
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  MODCAL_REQUIRE(stream.is_open(), "{}: cannot be opened: {}; check the path and its permissions",
                 file.string(), std::strerror(errno));
  std::string content;
  for (std::array<char, 1 << 14> block{}; stream;) {
    stream.read(block.data(), block.size());
    content.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  }
  MODCAL_REQUIRE(!stream.bad(), "{}: cannot be read: {}", file.string(), std::strerror(errno));
  return content;
}

OpenFile::OpenFile(fs::path path, int flags, std::string_view what) : path_(std::move(path)) {
  // Not blocking: a pipe that nobody writes to would hold up the opening.
  descriptor_ = open(path_.c_str(), flags | O_NONBLOCK | O_CLOEXEC, 0666);
  MODCAL_REQUIRE(descriptor_ >= 0 || errno != ELOOP, "{}: {} is a link, not a file: remove it",
                 path_.string(), what);
  MODCAL_REQUIRE(descriptor_ >= 0, "{}: {} cannot be opened: {}", path_.string(), what,
                 std::strerror(errno));
  struct stat status {};
  try {
    MODCAL_REQUIRE(fstat(descriptor_, &status) == 0, "{}: {} cannot be looked at: {}",
                   path_.string(), what, std::strerror(errno));
    MODCAL_REQUIRE(S_ISREG(status.st_mode), "{}: {} is {}, not a file: remove it", path_.string(),
                   what, name_of(status.st_mode));
    if ((flags & O_NOFOLLOW) != 0) require_own(status, path_, what);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

OpenFile OpenFile::for_reading(const fs::path& file, std::string_view what) {
  return OpenFile(file, O_RDONLY, what);
}

OpenFile OpenFile::for_appending(const fs::path& file, std::string_view what) {
  return OpenFile(file, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW, what);
}

OpenFile OpenFile::folder(const fs::path& folder, std::string_view what) {
  OpenFile result;
  result.path_ = folder;
  result.descriptor_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // One that may be written to and not be listed can be held, but not locked.
  if (result.descriptor_ < 0) {
    result.descriptor_ = open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
  }
  MODCAL_REQUIRE(result.descriptor_ >= 0, "{}: {} cannot be opened: {}", folder.string(), what,
                 std::strerror(errno));
  return result;
}

OpenFile::OpenFile(OpenFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void OpenFile::require_in_place(std::string_view what) const {
  struct stat open_file {
  }, named{};
  const bool in_place = fstat(descriptor_, &open_file) == 0 && stat(path_.c_str(), &named) == 0 &&
                        same_file(open_file, named);
  if (in_place) return;
  throw LostOutput(fmt::format(
      "{}: {} was deleted, moved or replaced while the command worked; what it held is not "
      "there: put it back, or run the same command again",
      path_.string(), what));
}

void remove_parts() noexcept {
  for (const std::atomic<const char*>& name : part_names) {
    if (const char* const part = name.load()) unlink(part);
  }
}

PartFile::PartFile(fs::path target)
    : target_(std::move(target)), part_(with_random_end(target_, kPart)) {
  // Named before it is made: a signal may come between the two.
  for (std::atomic<const char*>& name : part_names) {
    const char* none = nullptr;
    if (!name.compare_exchange_strong(none, part_.c_str())) continue;
    name_ = &name;
    break;
  }
  descriptor_ = make_new_file(part_);
  if (descriptor_ < 0 && name_ != nullptr) name_->store(nullptr);
  MODCAL_REQUIRE(descriptor_ >= 0,
                 "{}: cannot be written: {}; check the folder and its permissions",
                 target_.string(), std::strerror(errno));
  struct flock lock = first_byte(F_WRLCK);
  // Where a file system knows no locks, nothing is taken for abandoned either.
  static_cast<void>(fcntl(descriptor_, F_OFD_SETLK, &lock));
}

PartFile::~PartFile() {
  if (!part_.empty()) unlink(part_.c_str());
  if (name_ != nullptr) name_->store(nullptr);
  close(descriptor_);
}

void PartFile::put_in_place() {
  std::error_code error;
  fs::rename(part_, target_, error);
  MODCAL_REQUIRE(!error, "{}: cannot be written: {}", target_.string(), error.message());
  if (name_ != nullptr) std::exchange(name_, nullptr)->store(nullptr);
  part_.clear();
}

void make_own_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  MODCAL_REQUIRE(!error, "the folder {} cannot be made: {}; choose another one with --out",
                 folder.string(), error.message());
  MODCAL_REQUIRE(!fs::is_symlink(fs::symlink_status(folder, error)),
                 "{}: this is a link, not a folder: remove it", folder.string());
}

void remove_abandoned_parts(const fs::path& folder, const std::string& target) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path& file = entry->path();
    // "NAME.xxxxxxxx.part"
    const bool is_wanted = target.empty() || file.stem().stem() == target;
    if (is_part_name(file) && is_wanted && is_abandoned(file)) unlink(file.c_str());
  }
}

std::string why_not_writable(const fs::path& folder) {
  const fs::path probe = with_random_end(folder / ".modcal-write-test", "");
  const int descriptor = make_new_file(probe);
  const bool good = descriptor >= 0 && write(descriptor, "probe", 5) == 5;
  std::string reason = good ? std::string() : std::strerror(errno);
  if (descriptor >= 0) {
    close(descriptor);
    unlink(probe.c_str());
  }
  return reason;
}

}  // namespace modcal
