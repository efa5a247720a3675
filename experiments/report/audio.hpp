// Signals that the page plays.
#pragma once

#include <string>
#include <vector>

namespace modcal::report {

struct Track {
  std::string label = {};
  std::vector<double> samples = {};
};

/// Players, one a track; each is scaled to its own peak, so that quiet signals are heard. The files
/// of a report do not have them.
struct Audio {
  std::string id = {};  ///< anchor of its place in the page: [A-Za-z0-9_-]+
  std::string title = {};
  std::string caption = {};
  double sample_rate = 0.0;  ///< of all tracks [Hz]
  std::vector<Track> tracks = {};
};

/// Throws InvalidInput where the rate is not a whole number of hertz from 1000 to 192000, a track
/// is empty or longer than 60 s or has a value that is not finite, or the id cannot be an anchor.
void check_audio(const Audio& audio);

/// "data:audio/wav;base64,…": RIFF WAVE, one channel, 16 bits. The peak is at 0.9 of full scale, a
/// constant part is taken out, both ends fade over 5 ms.
std::string wav_data_uri(const std::vector<double>& samples, double sample_rate);

}  // namespace modcal::report
