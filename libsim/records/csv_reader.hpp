// Reads records from CSV files.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "libsim/records/recording.hpp"

namespace modcal {

struct CsvReadOptions {
  /// Columns to keep, in this order, by name or by number from 1 (all columns counted); empty: all
  /// but time.
  std::vector<std::string> columns = {};
  /// [Hz]; overrides what the file says (a difference becomes a warning). NaN: from the file.
  double sample_rate = std::numeric_limits<double>::quiet_NaN();
  /// Keep going over errors in the rows: they are listed in Recording::problems and their samples
  /// are NaN. Otherwise they throw.
  bool survey = false;
};

/// Reads a CSV record: an optional preamble of comments (# …), one row of headings `name [unit]`,
/// rows of decimal numbers. The sample rate comes from the options, from a comment
/// `# sample_rate: 51200 Hz`, or from the time column: the first one named t or time or whose unit
/// is a time; that column must be uniform (examine_time_axis). Throws InvalidInput with
/// file:line:column, value and remedy.
Recording read_csv(const std::filesystem::path& path, const CsvReadOptions& options = {});

}  // namespace modcal
