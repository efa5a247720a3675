// Reads records from CSV files.
#pragma once

#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libsim/records/recording.hpp"
#include "libsim/signal/signal.hpp"

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

// Writes signals as CSV records.

struct CsvWriteOptions {
  /// A first column t [s] = i/f_s.
  bool time_column = true;
  /// Where the samples come from; each line becomes a comment.
  std::vector<std::string> provenance = {};
};

/// Writes signals of one rate and length: comments with the sample rate and the provenance, the
/// headings `quantity [unit]`, one row per sample. Numbers are the shortest decimals that read back
/// to the same double, so read_csv returns the same bits. An existing file is replaced only when
/// the new one is complete. Throws InvalidInput for no signals, different rates or lengths, equal
/// names, samples that are not finite, and where the file cannot be written.
void write_csv(const std::filesystem::path& path, std::span<const Signal> signals,
               const CsvWriteOptions& options = {});

}  // namespace modcal
