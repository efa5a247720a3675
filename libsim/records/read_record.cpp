#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>

#include "libsim/base/files.hpp"
#include "libsim/records/formats.hpp"

namespace modcal {
namespace {

// Recordings in memory by their names.
struct Given {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const Recording>, std::less<>> recordings;
};
Given& given() {
  static Given table;
  return table;
}

std::shared_ptr<const Recording> find_given(const std::string& name) {
  const std::lock_guard lock(given().mutex);
  const auto found = given().recordings.find(name);
  return found == given().recordings.end() ? nullptr : found->second;
}

Recording read_given(const Recording& whole, const std::string& name, const ReadOptions& options) {
  Recording recording;
  recording.format = whole.format;
  recording.sample_rate = whole.sample_rate;
  recording.rate_source = whole.rate_source;
  if (std::isfinite(options.sample_rate)) recording.compare_rate(options.sample_rate, 0.0, name);
  std::vector<std::string> names;
  for (const RecordedChannel& channel : whole.channels) names.push_back(channel.name);
  for (const std::size_t index :
       find_channels(names, options.channels.empty() ? names : options.channels, name)) {
    recording.channels.push_back(whole.channels[index]);
  }
  return recording;
}

}  // namespace

std::optional<RecordSize> size_of_record(const std::filesystem::path& path,
                                         const std::string& format) {
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(path, error);
  if (!is_file || find_given(path.filename().string())) return std::nullopt;
  try {
    const Recording heads =
        record_format(path, format).read(path, {.survey = true, .headers_only = true});
    return RecordSize{static_cast<double>(heads.frames()),
                      static_cast<double>(heads.channels.size()), heads.sample_rate};
  } catch (const InvalidInput&) {
    return std::nullopt;  // whoever reads it says so
  }
}

void require_memory(const std::filesystem::path& path, const std::string& format, double memory) {
  if (std::isinf(memory)) return;
  const auto size = size_of_record(path, format);
  if (!size) return;
  const double bytes = size->bytes_to_read(size->channels);
  MODCAL_REQUIRE(bytes <= memory,
                 "{}: reading {:.3g} rows of {:g} channels needs about {:.3g} GB of memory, there "
                 "are {:.3g} GB; cut the record, or leave channels out",
                 path.string(), size->frames, size->channels, 1e-9 * bytes, 1e-9 * memory);
}

GivenRecording::GivenRecording(std::string name, Recording recording) : name_(std::move(name)) {
  recording.check_finite(name_);
  recording.refuse_problems();
  const std::lock_guard lock(given().mutex);
  const bool is_new =
      given()
          .recordings.emplace(name_, std::make_shared<const Recording>(std::move(recording)))
          .second;
  MODCAL_REQUIRE(is_new, "{}: another recording has this name; choose a different one", name_);
}

GivenRecording::~GivenRecording() {
  const std::lock_guard lock(given().mutex);
  given().recordings.erase(name_);
}

void Recording::check_finite(std::string_view file) {
  for (const RecordedChannel& channel : channels) {
    for (std::size_t i = 0; i < channel.samples.size(); ++i) {
      if (std::isfinite(channel.samples[i])) continue;
      add_problem(
          fmt::format("{}: sample {} of channel {} is {}; repair it, or keep only what stands "
                      "before or behind it",
                      file, i, channel.name, channel.samples[i]));
    }
  }
}

namespace {

// Its size and when it was written to; of what is no file any more nothing.
std::pair<std::uintmax_t, std::filesystem::file_time_type> state_of(
    const std::filesystem::path& path) {
  std::error_code ignored;
  return {std::filesystem::file_size(path, ignored),
          std::filesystem::last_write_time(path, ignored)};
}

}  // namespace

Recording read_record(const std::filesystem::path& path, const std::string& format,
                      const ReadOptions& options) {
  const std::string name = path.filename().string();
  if (const auto recording = find_given(name)) return read_given(*recording, name, options);
  require_regular_file(path);  // before its name is asked for a format
  if (!options.headers_only) require_memory(path, format, options.memory);
  ReadOptions judged = options;
  judged.memory = std::numeric_limits<double>::infinity();
  const auto before = state_of(path);
  Recording recording = record_format(path, format).read(path, judged);
  if (state_of(path) != before) {
    recording.add_problem(
        fmt::format("{}: the file was written to while it was read; try again when it is whole",
                    path.string()));
  }
  if (std::isfinite(recording.sample_rate) && !(recording.sample_rate > 0.0)) {
    recording.add_problem(
        fmt::format("{}: the file tells a sample rate of {:g} Hz ({}); state "
                    "sample_rate",
                    path.string(), recording.sample_rate, recording.rate_source));
  }
  if (!options.survey) recording.refuse_problems();
  return recording;
}

}  // namespace modcal
