#include <cmath>
#include <sndfile.hh>

#include "libsim/base/error.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

constexpr sf_count_t kBlockFrames = 1 << 14;

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

SndfileHandle open_wav(const std::string& name) {
  MODCAL_REQUIRE(!std::filesystem::is_directory(name), "{}: this is a folder, not a file", name);
  MODCAL_REQUIRE(std::filesystem::exists(name), "{}: there is no such file; check the path", name);
  MODCAL_REQUIRE(std::filesystem::file_size(name) > 0, "{}: the file is empty", name);
  SndfileHandle file(name);
  MODCAL_REQUIRE(file.error() == SF_ERR_NO_ERROR,
                 "{}: cannot be read as an audio file: {} for a CSV file, state format: csv", name,
                 file.strError());
  MODCAL_REQUIRE(file.frames() > 0, "{}: the file has {} channels but no samples", name,
                 file.channels());
  return file;
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
                  const std::string& name) {
  const auto width = static_cast<std::size_t>(file.channels());
  std::vector<double> block(width * kBlockFrames);
  for (RecordedChannel& channel : recording.channels) {
    channel.samples.reserve(static_cast<std::size_t>(file.frames()));
  }
  for (;;) {
    const auto frames = static_cast<std::size_t>(file.readf(block.data(), kBlockFrames));
    if (frames == 0) break;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      std::vector<double>& samples = recording.channels[c].samples;
      for (std::size_t i = 0; i < frames; ++i) samples.push_back(block[i * width + chosen[c]]);
    }
  }
  MODCAL_REQUIRE(recording.frames() == static_cast<std::size_t>(file.frames()),
                 "{}: the header announces {} samples, the file has {}; it was cut off: copy it "
                 "again",
                 name, file.frames(), recording.frames());
}

void check_samples(Recording& recording, const std::string& name) {
  for (const RecordedChannel& channel : recording.channels) {
    for (std::size_t i = 0; i < channel.samples.size(); ++i) {
      if (std::isfinite(channel.samples[i])) continue;
      recording.add_problem(
          fmt::format("{}: sample {} of channel {} is {}; repair the record or crop it away", name,
                      i, channel.name, channel.samples[i]));
    }
  }
}

}  // namespace

Recording read_wav(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string name = path.string();
  SndfileHandle file = open_wav(name);
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
  read_samples(file, chosen, recording, name);
  check_samples(recording, name);
  if (!options.survey) recording.refuse_problems();
  return recording;
}

}  // namespace modcal
