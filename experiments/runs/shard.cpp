#include "experiments/runs/shard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>

#include "libsim/base/error.hpp"

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

int open_lock_file(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  MODCAL_REQUIRE(descriptor >= 0, "{}: the lock cannot be opened: {}", file.string(),
                 std::strerror(errno));
  return descriptor;
}

bool take(int descriptor, short type) {
  struct flock lock = whole_file(type);
  return fcntl(descriptor, F_OFD_SETLK, &lock) == 0;
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

RunLock::RunLock(const std::filesystem::path& folder, const Shard& shard) {
  const std::filesystem::path folder_lock = folder / kFolderLock;
  const std::filesystem::path shard_lock =
      folder / fmt::format("shard-{}-of-{}.lock", shard.index, shard.count);
  folder_descriptor_ = open_lock_file(folder_lock);
  shard_descriptor_ = open_lock_file(shard_lock);
  const bool taken = take(folder_descriptor_, shard.is_whole() ? F_WRLCK : F_RDLCK) &&
                     take(shard_descriptor_, F_WRLCK);
  if (!taken) {
    const std::string holder = holder_of(shard_lock);
    close(folder_descriptor_);
    close(shard_descriptor_);
    throw InvalidInput(
        fmt::format("another run works in {}{}; wait for it, stop it or choose another folder "
                    "with --out",
                    folder.parent_path().string(), holder));
  }
  const std::string name = own_name();
  if (ftruncate(shard_descriptor_, 0) == 0) {
    // The name is a courtesy to whoever is refused: the lock holds without it.
    static_cast<void>(write(shard_descriptor_, name.data(), name.size()) > 0);
  }
}

RunLock::~RunLock() {
  if (ftruncate(shard_descriptor_, 0) != 0) errno = 0;
  close(shard_descriptor_);
  close(folder_descriptor_);
}

bool is_running(const std::filesystem::path& folder) {
  const int descriptor = open((folder / kFolderLock).c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return false;
  struct flock lock = whole_file(F_WRLCK);
  const bool held = fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  close(descriptor);
  return held;
}

}  // namespace modcal
