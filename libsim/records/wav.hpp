// Reads records from audio files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/records/recording.hpp"
#include "libsim/signal/signal.hpp"

namespace modcal {

struct WavReadOptions {
  /// Channels to keep, in this order, by name or number from 1; empty: all.
  std::vector<std::string> channels = {};
  /// [Hz]; overrides the file's (a difference becomes a warning). NaN: from the file.
  double sample_rate = std::numeric_limits<double>::quiet_NaN();
  /// Samples that are NaN or infinite are listed in Recording::problems instead of thrown.
  bool survey = false;
};

/// Reads a WAV record (also RF64, WAVEX, W64 and what else libsndfile opens): any channel count;
/// samples of 8, 16, 24, 32 bits are divided by their full scale 2^(bits−1), float and double are
/// taken as they are. Names, units and full scales come from the file's comment where write_wav
/// left them; else the names are "1", "2", … and the full scale is NaN. Throws InvalidInput with
/// file, channel, sample and remedy.
Recording read_wav(const std::filesystem::path& path, const WavReadOptions& options = {});

// Writes signals as WAV records.

enum class WavSamples { kFloat, kDouble, kPcm24 };

struct WavWriteOptions {
  WavSamples samples = WavSamples::kFloat;
  /// The signals' unit per full scale 1.0 (> 0): a sample x is stored as x/full_scale. A power of
  /// two with kDouble keeps every bit.
  double full_scale = 1.0;
  /// Where the samples come from; stored in the file's title.
  std::string provenance = {};
};

/// Writes signals of one rate and length, one per channel, with their names, units and full scale
/// in the file's comment (JSON), so that read_wav restores them; RF64 where a WAV file's 32-bit
/// sizes do not suffice. 24-bit samples are rounded to full_scale 2^−23. An existing file is
/// replaced only when the new one is complete. Throws InvalidInput where the rate is no whole
/// number of hertz, where a sample is not finite or, for 24 bits, beyond full scale, and where the
/// file cannot be written.
void write_wav(const std::filesystem::path& path, std::span<const Signal> signals,
               const WavWriteOptions& options = {});

/// Whether a file with this many bytes of samples needs RF64 (EBU Tech 3306) in the place of WAV.
bool needs_rf64(std::uint64_t sample_bytes);

}  // namespace modcal
