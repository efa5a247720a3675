// Writes signals as WAV records.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "libsim/signal/signal.hpp"

namespace modcal {

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
