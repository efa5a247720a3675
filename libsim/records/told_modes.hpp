// How many modes of a string a record can tell.
#pragma once

#include "libsim/model/string_model.hpp"
#include "libsim/records/recording.hpp"

namespace modcal {

struct ToldModes {
  std::int64_t count = 0;         ///< N
  std::int64_t standing_out = 0;  ///< modes up to the last that stands out of the noise
  std::int64_t in_band = 0;       ///< modes of the stated law below `highest`
  double highest = 0.0;           ///< 0.4 f_s [Hz]
  /// "70 modes: those below …", for a report.
  std::string text() const;
};

/// The modes of the stated law below 0.4 f_s, up to the highest whose neighborhood f_n ± f0/2 holds
/// 1.5 times the power of the noise in either reaction, but the first ten in any case, and
/// sixty at most. The noise
/// is taken to be white (white_noise_rms()); a record too short to show it tells all modes of the
/// band. One too few is held by the modes above (`remainder: law`).
/// Throws InvalidInput where fewer than two modes lie in the band.
ToldModes told_modes(const StringModel& string, const RecordedSignals& record);

}  // namespace modcal
