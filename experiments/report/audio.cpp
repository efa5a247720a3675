#include "experiments/report/audio.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "experiments/report/encoding.hpp"
#include "experiments/report/figure.hpp"
#include "libsim/base/error.hpp"

namespace modcal::report {
namespace {

constexpr double kPeak = 0.9;
constexpr double kFade = 5e-3;  // [s]: without it both ends click

// Samples in [−1, 1].
std::vector<double> leveled(const std::vector<double>& samples, double sample_rate) {
  double mean = 0.0;
  for (const double sample : samples) mean += sample / static_cast<double>(samples.size());
  double peak = 0.0;
  for (const double sample : samples) peak = std::max(peak, std::abs(sample - mean));
  // What rounding leaves of a constant is silence.
  const double scale = peak > 1e-12 * std::abs(mean) ? kPeak / peak : 0.0;
  const double fade = std::max(1.0, kFade * sample_rate);
  std::vector<double> result(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto to_end = static_cast<double>(std::min(i, samples.size() - 1 - i));
    result[i] = scale * (samples[i] - mean) * std::min(1.0, to_end / fade);
  }
  return result;
}

class LittleEndian {
 public:
  void text(std::string_view letters) { bytes.insert(bytes.end(), letters.begin(), letters.end()); }
  void number(std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(static_cast<unsigned char>(value >> (8 * i)));
  }
  std::vector<unsigned char> bytes;
};

}  // namespace

void check_audio(const Audio& audio) {
  MODCAL_REQUIRE(is_file_stem(audio.id),
                 "\"{}\" cannot name a place in the page; use letters, digits, - and _", audio.id);
  const double rate = audio.sample_rate;
  MODCAL_REQUIRE(rate == std::round(rate) && rate >= 1000.0 && rate <= 192000.0,
                 "audio \"{}\": {} Hz cannot be played; use whole hertz from 1000 to 192000",
                 audio.id, rate);
  for (const Track& track : audio.tracks) {
    MODCAL_REQUIRE(
        !track.samples.empty() && static_cast<double>(track.samples.size()) <= 60.0 * rate,
        "audio \"{}\": track \"{}\" has {} samples; it must last up to 60 s", audio.id, track.label,
        track.samples.size());
    MODCAL_REQUIRE(std::all_of(track.samples.begin(), track.samples.end(),
                               [](double sample) { return std::isfinite(sample); }),
                   "audio \"{}\": track \"{}\" has values that are not finite", audio.id,
                   track.label);
  }
}

std::string wav_data_uri(const std::vector<double>& samples, double sample_rate) {
  const auto rate = static_cast<std::uint32_t>(sample_rate);
  const auto size = static_cast<std::uint32_t>(2 * samples.size());
  LittleEndian wav;
  wav.text("RIFF");
  wav.number(36 + size, 4);
  wav.text("WAVEfmt ");
  wav.number(16, 4);
  wav.number(1, 2);  // PCM
  wav.number(1, 2);  // channel
  wav.number(rate, 4);
  wav.number(2 * rate, 4);
  wav.number(2, 2);
  wav.number(16, 2);
  wav.text("data");
  wav.number(size, 4);
  for (const double sample : leveled(samples, sample_rate)) {
    wav.number(static_cast<std::uint32_t>(std::lround(32767.0 * sample)), 2);
  }
  return "data:audio/wav;base64," + base64(wav.bytes);
}

}  // namespace modcal::report
