// Files in folders that others may write to, and files that may vanish while they are in use.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

namespace modcal {

/// What was computed and has not reached the user: results that were deleted while the work went
/// on, output that nobody could take.
class LostOutput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws InvalidInput where `file` is there and is no regular file: reading a pipe would wait, a
/// device need not end. Nothing is opened.
void require_regular_file(const std::filesystem::path& file);

/// The content of a regular file. Throws InvalidInput where it cannot be read.
std::string content_of_file(const std::filesystem::path& file);

/// An open file that is known by its name and by its place on the disk.
class OpenFile {
 public:
  OpenFile() = default;
  /// Throws InvalidInput where there is no regular file that can be read; `what` it is to be, such
  /// as "the journal".
  static OpenFile for_reading(const std::filesystem::path& file, std::string_view what);
  /// Opens for reading and appending; makes a file that is not there. Throws InvalidInput unless it
  /// is a regular file, no link, of one name, that belongs to the user or to the owner of its
  /// folder.
  static OpenFile for_appending(const std::filesystem::path& file, std::string_view what);
  /// Throws InvalidInput where it cannot be opened.
  static OpenFile folder(const std::filesystem::path& folder, std::string_view what);
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;

  int descriptor() const { return descriptor_; }
  const std::filesystem::path& path() const { return path_; }
  /// Throws LostOutput where the file no longer has its name.
  void require_in_place(std::string_view what) const;

 private:
  OpenFile(std::filesystem::path path, int flags, std::string_view what);
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// A new file "NAME.xxxxxxxx.part" beside the one it will replace; unless it is put in place, it is
/// removed. While it is there it is locked, so that what killed processes left can be told.
class PartFile {
 public:
  /// Throws InvalidInput where it cannot be made.
  explicit PartFile(std::filesystem::path target);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  const std::filesystem::path& path() const { return part_; }
  /// An existing file is replaced. Throws InvalidInput where that fails.
  void put_in_place();

 private:
  std::filesystem::path target_, part_;
  int descriptor_ = -1;
  std::atomic<const char*>* name_ = nullptr;
};

/// Removes every part file of this process, which has to end then. For the handler of a signal.
void remove_parts() noexcept;

/// Makes a folder of ours, and those above it. Throws InvalidInput where that fails, and where a
/// link stands in its place: what is written below would go where somebody else wants it.
void make_own_folder(const std::filesystem::path& folder);

/// Removes the part files in a folder, not below it, that no process is writing; with a `target`
/// those of this file alone.
void remove_abandoned_parts(const std::filesystem::path& folder, const std::string& target = {});

/// Why no file can be made in the folder; empty where one can. What is there stays as it is.
std::string why_not_writable(const std::filesystem::path& folder);

}  // namespace modcal
