// A file of lines with blocks of bytes between them; it knows where it is.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace modcal {

/// A place in a file: byte from 0, line from 1 (a block of bytes counts as no line).
struct FilePlace {
  std::uint64_t byte = 0;
  std::size_t line = 1;
};

class LineFile {
 public:
  /// Throws InvalidInput where there is no regular file that can be read, or an empty one.
  explicit LineFile(const std::filesystem::path& path);

  /// The next line without its end; false at the end of the file.
  bool next(std::string& line);
  /// `size` bytes. Throws InvalidInput where fewer are left; nothing is allocated then.
  std::string bytes(std::uint64_t size);
  void skip(std::uint64_t size);
  void go_to(FilePlace place);

  FilePlace place() const { return place_; }
  std::uint64_t size() const { return size_; }
  std::uint64_t left() const { return size_ - place_.byte; }
  const std::string& name() const { return name_; }

 private:
  void require_left(std::uint64_t size) const;

  std::string name_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  FilePlace place_;
};

}  // namespace modcal
