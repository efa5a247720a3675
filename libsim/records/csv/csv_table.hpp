// Columns of numbers as a CSV file has them.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "libsim/records/response_functions.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {

/// Writes a row of headings, comments (a line each) and `rows` rows, which append_row(i, row) adds
/// to an empty one. Numbers are the shortest decimals that read back to the same double. An
/// existing file is replaced only when the new one is complete. Throws InvalidInput where the file
/// cannot be written.
void write_csv_table(const std::filesystem::path& path, std::span<const std::string> headings,
                     std::span<const std::string> comments, std::size_t rows,
                     const std::function<void(std::size_t, std::vector<double>&)>& append_row);

/// Of a CSV file: a column frequency [Hz], and for each function "NAME" or "NAME real" with "NAME
/// imaginary", or "NAME" with "NAME phase [deg]" or [rad]; a column by itself is a coherence.
/// Throws InvalidInput for what is no such table.
std::vector<StoredChannel> csv_functions(const std::filesystem::path& path);

/// Writes the columns frequency [Hz], "NAME [unit]" and "NAME imaginary [unit]" of functions of the
/// same lines. Throws InvalidInput as require_functions() does, and for names that no heading
/// bears.
void write_csv_functions(const std::filesystem::path& path, std::span<const FileFunction> functions,
                         const std::string& provenance);

}  // namespace modcal
