// Writes signals as CSV records.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "libsim/signal/signal.hpp"

namespace modcal {

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
