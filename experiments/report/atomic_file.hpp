#pragma once

#include <filesystem>
#include <string_view>

namespace modcal::report {

/// Writes `content` under a temporary name beside `file` and renames it: readers see the old file
/// or the new one, never a part. Throws InvalidInput with the reason where that fails (no space, no
/// permission).
void write_file_atomically(const std::filesystem::path& file, std::string_view content);

}  // namespace modcal::report
