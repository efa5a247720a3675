// The formats of recorded files: readers, writers, schema and help know them from here.
#pragma once

#include <span>

#include "libsim/records/record_file.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {

struct RecordFormat {
  std::string_view name;     ///< of `format:` in YAML
  std::string_view meaning;  ///< for help
  std::vector<std::string_view> extensions;
  Recording (*read)(const std::filesystem::path& path, const ReadOptions& options);
  /// Keeps every bit of the samples; nothing: the format is only read.
  void (*write)(const std::filesystem::path& path, std::span<const Signal> signals,
                const RecordNotes& notes) = nullptr;
  /// What stands in a file that may be a function of frequency, headers and lines; null: the format
  /// keeps none.
  std::vector<StoredChannel> (*functions)(const std::filesystem::path& path) = nullptr;
  /// Keeps every bit of values and lines; null: the format is not written with functions.
  void (*write_functions)(const std::filesystem::path& path,
                          std::span<const FileFunction> functions,
                          const std::string& provenance) = nullptr;
  /// Of functions: power spectra, too, and each may have lines of its own.
  bool keeps_any_function = false;
  /// Has no place for the instant of the first sample.
  bool begins_at_zero = false;
};

/// Those this program was built with.
std::span<const RecordFormat> record_formats();

/// "auto" and the names of all formats, for options.
std::vector<std::string_view> record_format_choices();

/// The format named, or for "auto" the one that the extension tells. Throws InvalidInput.
const RecordFormat& record_format(const std::filesystem::path& path, const std::string& name);

}  // namespace modcal
