#include <algorithm>
#include <cmath>
#include <sndfile.hh>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/signal_file.hpp"
#include "libsim/signal/statistics.hpp"

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
    const double peak = largest_magnitude(signal.samples);
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

std::string describe_format(SndfileHandle& file, int format) {
  SF_FORMAT_INFO container{.format = format & SF_FORMAT_TYPEMASK, .name = "", .extension = ""};
  SF_FORMAT_INFO samples{.format = format & SF_FORMAT_SUBMASK, .name = "", .extension = ""};
  SNDFILE* const handle = file.rawHandle();
  sf_command(handle, SFC_GET_FORMAT_INFO, &container, sizeof container);
  sf_command(handle, SFC_GET_FORMAT_INFO, &samples, sizeof samples);
  return fmt::format("{}, {}", container.name, samples.name);
}

/// libsndfile reads what is left of a file that was cut off and notes so in its log only.
bool is_cut_off(SndfileHandle& file) {
  std::string log(1 << 14, '\0');
  file.command(SFC_GET_LOG_INFO, log.data(), static_cast<int>(log.size()));
  const std::size_t data = log.find("\ndata :");
  return data != std::string::npos && log.find("(should be", data) < log.find('\n', data + 1);
}

void require_bytes(const std::string& name) {
  require_regular_file(name);
  MODCAL_REQUIRE(std::filesystem::exists(name), "{}: there is no such file; check the path", name);
  MODCAL_REQUIRE(std::filesystem::file_size(name) > 0, "{}: the file is empty", name);
}

void require_samples(SndfileHandle& file, const std::string& name) {
  std::string reason = file.strError();
  reason.erase(reason.find_last_not_of(". ") + 1);
  MODCAL_REQUIRE(file.error() == SF_ERR_NO_ERROR,
                 "{}: cannot be read as an audio file ({}); for a CSV file, state format: csv",
                 name, reason);
  MODCAL_REQUIRE(file.frames() > 0, "{}: the file has {} channels but no samples", name,
                 file.channels());
}

/// Positions of the wanted channels in a frame.
std::vector<std::size_t> chosen_channels(const std::vector<RecordedChannel>& channels,
                                         const std::vector<std::string>& wanted,
                                         const std::string& name) {
  std::vector<std::string> names;
  for (const RecordedChannel& channel : channels) names.push_back(channel.name);
  std::vector<std::size_t> chosen = find_channels(names, wanted, name);
  for (std::size_t i = 0; wanted.empty() && i < names.size(); ++i) chosen.push_back(i);
  return chosen;
}

void read_samples(SndfileHandle& file, const std::vector<std::size_t>& chosen, Recording& recording,
                  const StopToken& stop, const std::string& name) {
  const auto width = static_cast<std::size_t>(std::max(1, file.channels()));
  const std::size_t block_frames = std::max<std::size_t>(1, 2 * kBlockFrames / width);
  std::vector<double> block(width * block_frames);
  for (RecordedChannel& channel : recording.channels) {
    channel.samples.reserve(static_cast<std::size_t>(file.frames()));
  }
  for (;;) {
    const auto frames =
        static_cast<std::size_t>(file.readf(block.data(), static_cast<sf_count_t>(block_frames)));
    if (frames == 0) break;
    stop.throw_if_requested();
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      std::vector<double>& samples = recording.channels[c].samples;
      for (std::size_t i = 0; i < frames; ++i) samples.push_back(block[i * width + chosen[c]]);
    }
  }
  const std::size_t frames_read = recording.channels.front().samples.size();
  MODCAL_REQUIRE(frames_read == static_cast<std::size_t>(file.frames()),
                 "{}: the header announces {} samples, the file has {}; it was cut off: copy it "
                 "again",
                 name, file.frames(), frames_read);
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

Recording read_wav(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string name = path.string();
  require_bytes(name);
  if (!options.headers_only) require_memory(path, "wav", options.memory);
  SndfileHandle file(name);
  require_samples(file, name);
  const char* const comment = file.getString(SF_STR_COMMENT);
  std::vector<RecordedChannel> channels = channels_of_comment(
      comment == nullptr ? "" : comment, static_cast<std::size_t>(file.channels()));
  const std::vector<std::size_t> chosen = chosen_channels(channels, options.channels, name);
  Recording recording;
  recording.format = describe_format(file, file.format());
  recording.sample_rate = file.samplerate();
  recording.rate_source = "header";
  if (is_cut_off(file)) {
    recording.warnings.push_back(
        fmt::format("{}: the header announces more samples than the {} in the file; it was cut off",
                    name, file.frames()));
  }
  if (std::isfinite(options.sample_rate)) {
    recording.compare_rate(options.sample_rate, 0.0, name);
  }
  for (const std::size_t index : chosen) recording.channels.push_back(std::move(channels[index]));
  recording.stated_frames = static_cast<std::size_t>(file.frames());
  if (options.headers_only) return recording;
  read_samples(file, chosen, recording, options.stop, name);
  recording.check_finite(name);
  if (!options.survey) recording.refuse_problems();
  return recording;
}

}  // namespace modcal
