// Reads records from audio files.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "libsim/records/recording.hpp"

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

}  // namespace modcal
