// The folder a run leaves its results in.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace modcal {

class OutputDirectory {
 public:
  /// Makes the folder and checks that files can be written there, before anything is computed.
  /// Throws InvalidInput where they cannot.
  explicit OutputDirectory(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  /// Writes the whole file under a temporary name and renames it: an existing file is replaced by a
  /// complete one or not at all. Throws InvalidInput where that fails (no space, no permission).
  void write_text(std::string_view name, std::string_view content) const;

 private:
  std::filesystem::path path_;
};

}  // namespace modcal
