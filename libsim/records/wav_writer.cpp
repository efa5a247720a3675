#include <algorithm>
#include <cmath>
#include <sndfile.hh>

#include "libsim/base/error.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

constexpr std::size_t kBlockFrames = 1 << 14;
constexpr int kCodes24 = 1 << 23;

// How libsndfile calls samples, and their bytes; in the order of WavSamples.
struct SampleFormat {
  int format;
  std::uint64_t bytes;
};
constexpr std::array<SampleFormat, 3> kFormats = {
    {{SF_FORMAT_FLOAT, 4}, {SF_FORMAT_DOUBLE, 8}, {SF_FORMAT_PCM_24, 3}}};

void require_fitting(std::span<const Signal> signals, const WavWriteOptions& options,
                     const std::string& name) {
  const double rate = signals.front().sample_rate;
  MODCAL_REQUIRE(rate == std::round(rate) && rate <= std::numeric_limits<int>::max(),
                 "{}: a WAV file cannot hold a sample rate of {} Hz, only whole numbers of hertz; "
                 "write CSV",
                 name, rate);
  MODCAL_REQUIRE(options.full_scale > 0.0 && std::isfinite(options.full_scale),
                 "{}: full_scale = {} cannot be used: it must be > 0", name, options.full_scale);
  const double largest = options.samples == WavSamples::kFloat
                             ? static_cast<double>(std::numeric_limits<float>::max())
                             : std::numeric_limits<double>::max();
  // The largest code of 24 bits is one step below full scale.
  const double limit = options.samples == WavSamples::kPcm24 ? 1.0 - 0.5 / kCodes24 : largest;
  for (const Signal& signal : signals) {
    double peak = 0.0;
    for (const double value : signal.samples) peak = std::max(peak, std::abs(value));
    MODCAL_REQUIRE(peak / options.full_scale <= limit,
                   "{}: {} reaches {:g} {}, beyond what full_scale = {:g} can hold; choose a "
                   "full_scale above its peak",
                   name, signal.quantity, peak, signal.unit, options.full_scale);
  }
}

/// Integers are scaled here: libsndfile writes with 2^23 − 1 and reads with 2^23.
int code24(double value) {
  const double code = std::round(value * kCodes24);
  return static_cast<int>(std::min(code, kCodes24 - 1.0)) * 256;
}

template <typename Sample, typename Store>
void write_blocks(SndfileHandle& file, std::span<const Signal> signals, const std::string& name,
                  Store store) {
  const std::size_t frames = signals.front().size();
  std::vector<Sample> block;
  for (std::size_t start = 0; start < frames; start += kBlockFrames) {
    const std::size_t end = std::min(frames, start + kBlockFrames);
    block.clear();
    for (std::size_t i = start; i < end; ++i) {
      for (const Signal& signal : signals) block.push_back(store(signal.samples[i]));
    }
    const auto count = static_cast<sf_count_t>(end - start);
    MODCAL_REQUIRE(file.writef(block.data(), count) == count,
                   "{}: writing failed: {}; is the disk full?", name, file.strError());
  }
}

void write_samples(SndfileHandle& file, std::span<const Signal> signals,
                   const WavWriteOptions& options, const std::string& name) {
  const double scale = options.full_scale;
  switch (options.samples) {
    case WavSamples::kFloat:
      return write_blocks<float>(
          file, signals, name, [scale](double value) { return static_cast<float>(value / scale); });
    case WavSamples::kDouble:
      return write_blocks<double>(file, signals, name,
                                  [scale](double value) { return value / scale; });
    case WavSamples::kPcm24:
      return write_blocks<int>(file, signals, name,
                               [scale](double value) { return code24(value / scale); });
  }
}

}  // namespace

bool needs_rf64(std::uint64_t sample_bytes) {
  // RIFF counts bytes in 32 bits; a mebibyte is left for the header and the comment.
  return sample_bytes > std::numeric_limits<std::uint32_t>::max() - (1ULL << 20);
}

void write_wav(const std::filesystem::path& path, std::span<const Signal> signals,
               const WavWriteOptions& options) {
  const std::string name = path.string();
  require_one_record(signals, name);
  require_fitting(signals, options, name);
  const SampleFormat format = kFormats.at(static_cast<std::size_t>(options.samples));
  const std::uint64_t bytes = format.bytes * signals.size() * signals.front().size();
  const std::string comment = wav_comment(signals, options.full_scale);
  MODCAL_REQUIRE(comment.size() <= kLongestWavComment,
                 "{}: the names of {} channels do not fit into the file's comment; write CSV", name,
                 signals.size());
  const int container = needs_rf64(bytes) ? SF_FORMAT_RF64 : SF_FORMAT_WAV;
  replace_file(path, [&](const std::filesystem::path& temporary) {
    SndfileHandle file(temporary.string(), SFM_WRITE, container | format.format,
                       static_cast<int>(signals.size()),
                       static_cast<int>(signals.front().sample_rate));
    MODCAL_REQUIRE(file.error() == SF_ERR_NO_ERROR,
                   "{}: cannot be written: {} Check the folder and its permissions", name,
                   file.strError());
    // The PEAK chunk holds the time of day; equal signals shall give equal bytes.
    file.command(SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
    file.setString(SF_STR_COMMENT, comment.c_str());
    if (!options.provenance.empty()) file.setString(SF_STR_TITLE, options.provenance.c_str());
    write_samples(file, signals, options, name);
  });
}

}  // namespace modcal
