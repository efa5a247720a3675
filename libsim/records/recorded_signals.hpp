// Recorded forces, ready for inversion and calibration.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libsim/records/record_options.hpp"
#include "libsim/records/recording.hpp"
#include "libsim/signal/signal.hpp"

namespace modcal {

/// Forces [N] of one sample rate [Hz] and one length; at least one reaction.
struct RecordedSignals {
  double sample_rate = 0.0;
  std::optional<Signal> left;       ///< R1 at x = 0
  std::optional<Signal> right;      ///< R2 at x = L
  std::optional<Signal> reference;  ///< f_c at the contact
  std::vector<std::string> warnings;

  std::size_t size() const { return left ? left->size() : right->size(); }
};

enum class RecordFormat { kCsv, kWav };

/// The format named "csv", "wav" or, for "auto", told by the extension (.csv, .tsv, .txt; .wav,
/// .wave, .rf64, .bwf, .w64). Throws InvalidInput for another one.
RecordFormat record_format(const std::filesystem::path& path, const std::string& format);

/// Reads the chosen channels of the file (relative to `folder`), converts them to newtons, shifts
/// them by their delays and crops them. Throws InvalidInput for a file that cannot be used, a
/// channel without a unit of force and without a calibration, a channel used twice, a window
/// outside the record.
RecordedSignals load_record(const RecordOptions& options, const std::filesystem::path& folder);

}  // namespace modcal
