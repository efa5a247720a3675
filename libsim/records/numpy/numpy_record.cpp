#include <zip.h>

#include <fstream>
#include <mutex>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/numpy/npy_arrays.hpp"
#include "libsim/records/numpy/numpy_file.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;

std::uint64_t size_of(const Path& path) {
  require_regular_file(path);
  MODCAL_REQUIRE(std::filesystem::exists(path), "{}: there is no such file; check the path",
                 path.string());
  const std::uint64_t size = std::filesystem::file_size(path);
  MODCAL_REQUIRE(size > 0, "{}: the file is empty", path.string());
  return size;
}

NpyBytes bytes_of_file(const Path& path) {
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  MODCAL_REQUIRE(file->is_open(), "{}: cannot be opened; check the path and its permissions",
                 path.string());
  return
      [file, place = path.string(), at = std::uint64_t{0}](char* bytes, std::size_t size) mutable {
        file->read(bytes, static_cast<std::streamsize>(size));
        at += static_cast<std::uint64_t>(file->gcount());
        MODCAL_REQUIRE(file->gcount() == static_cast<std::streamsize>(size),
                       "{}: byte {}: the file ends within the array; it was cut off", place, at);
      };
}

// An archive that is open as long as a channel may be asked for: opening it reads the entries of
// all. One thread at a time reads of it.
class Archive {
 public:
  explicit Archive(const Path& path) {
    int code = 0;
    zip_ = zip_open(path.c_str(), ZIP_RDONLY, &code);
    if (zip_ != nullptr) return;
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    throw_invalid_input(
        "{}: byte {}: no directory of a ZIP archive stands before the file's end ({}); it was cut "
        "off, or it is no NPZ file",
        path.string(), std::filesystem::file_size(path), why);
  }
  ~Archive() { zip_discard(zip_); }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;
  zip_t* zip() const { return zip_; }
  std::mutex& lock() { return lock_; }

 private:
  std::mutex lock_;
  zip_t* zip_ = nullptr;
};

// One of its files, open.
class Member {
 public:
  Member(std::shared_ptr<Archive> archive, std::uint64_t index, const std::string& place)
      : archive_(std::move(archive)) {
    const std::lock_guard lock(archive_->lock());
    file_ = zip_fopen_index(archive_->zip(), index, 0);
    MODCAL_REQUIRE(file_ != nullptr, "{}: cannot be read: {}", place,
                   zip_strerror(archive_->zip()));
  }
  ~Member() {
    const std::lock_guard lock(archive_->lock());
    zip_fclose(file_);
  }
  Member(const Member&) = delete;
  Member& operator=(const Member&) = delete;
  zip_file_t* file() const { return file_; }
  std::mutex& lock() const { return archive_->lock(); }

 private:
  std::shared_ptr<Archive> archive_;
  zip_file_t* file_ = nullptr;
};

NpyBytes bytes_of_member(const std::shared_ptr<Archive>& archive, std::uint64_t index,
                         std::uint64_t all, const std::string& place) {
  return [member = std::make_shared<Member>(archive, index, place), place, all,
          at = std::uint64_t{0}](char* bytes, std::size_t size) mutable {
    const std::lock_guard lock(member->lock());
    zip_file_t* const file = member->file();
    const zip_int64_t read = zip_fread(file, bytes, size);
    if (read > 0) at += static_cast<std::uint64_t>(read);
    MODCAL_REQUIRE(read >= 0, "{}: byte {}: {}: the file is damaged", place, at,
                   zip_file_strerror(file));
    MODCAL_REQUIRE(static_cast<std::uint64_t>(read) == size,
                   "{}: byte {}: it ends within the array", place, at);
    // The checksum is compared where a byte behind the last one is asked for.
    char none = 0;
    if (at == all && zip_fread(file, &none, 1) < 0) {
      throw_invalid_input("{}: {}: the file is damaged", place, zip_file_strerror(file));
    }
  };
}

// "R1.unit" is the unit of R1; other names keep their dots.
std::vector<std::string> names_of_member(std::string member) {
  constexpr std::string_view kEnding = ".npy", kUnit = ".unit";
  member.resize(member.size() - kEnding.size());
  member = utf8_or_latin1(member);
  if (member.size() <= kUnit.size() || !member.ends_with(kUnit)) return {member};
  member.resize(member.size() - kUnit.size());
  return {member, std::string(kUnit.substr(1))};
}

std::shared_ptr<NpyArrays> array_of(const Path& path) {
  const std::uint64_t size = size_of(path);
  auto arrays = std::make_shared<NpyArrays>();
  arrays->add({utf8_or_latin1(path.stem().string())}, path.string(), size,
              [path] { return bytes_of_file(path); });
  return arrays;
}

std::shared_ptr<NpyArrays> arrays_of(const Path& path) {
  size_of(path);
  auto arrays = std::make_shared<NpyArrays>();
  const auto archive = std::make_shared<Archive>(path);
  const zip_int64_t count = zip_get_num_entries(archive->zip(), 0);
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(std::max<zip_int64_t>(0, count)); ++i) {
    zip_stat_t stat;
    const bool known = zip_stat_index(archive->zip(), i, 0, &stat) == 0 &&
                       (stat.valid & ZIP_STAT_NAME) != 0 && (stat.valid & ZIP_STAT_SIZE) != 0;
    if (!known || !std::string_view(stat.name).ends_with(".npy")) continue;
    const std::string place = fmt::format("{}: {}", path.string(), utf8_or_latin1(stat.name));
    arrays->add(names_of_member(stat.name), place, stat.size, [archive, i, all = stat.size, place] {
      return bytes_of_member(archive, i, all, place);
    });
  }
  MODCAL_REQUIRE(!arrays->arrays().empty(), "{}: no array of NumPy stands in this archive",
                 path.string());
  return arrays;
}

}  // namespace

Recording read_npy(const Path& path, const ReadOptions& options) {
  return recording_of(array_of(path), "NumPy array", path, options);
}

Recording read_npz(const Path& path, const ReadOptions& options) {
  return recording_of(arrays_of(path), "NumPy archive", path, options);
}

std::vector<StoredChannel> npy_functions(const Path& path) {
  return functions_of(array_of(path), path);
}

std::vector<StoredChannel> npz_functions(const Path& path) {
  return functions_of(arrays_of(path), path);
}

}  // namespace modcal
