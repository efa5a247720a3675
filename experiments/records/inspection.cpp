#include "experiments/records/inspection.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "libsim/base/units.hpp"
#include "libsim/records/csv_reader.hpp"
#include "libsim/records/recorded_signals.hpp"
#include "libsim/records/wav_reader.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

Recording survey(const std::filesystem::path& path, const InspectionOptions& options) {
  if (record_format(path, options.format) == RecordFormat::kCsv) {
    return read_csv(path, {.sample_rate = options.sample_rate, .survey = true});
  }
  return read_wav(path, {.sample_rate = options.sample_rate, .survey = true});
}

ChannelInspection inspect_channel(RecordedChannel& channel) {
  const bool scaled = std::isfinite(channel.full_scale);
  if (scaled && channel.full_scale != 1.0) {
    for (double& value : channel.samples) value *= channel.full_scale;
  }
  return {.name = channel.name,
          .unit = scaled ? channel.unit : "full scale",
          .levels = measure_levels(channel.samples),
          .clipping = find_clipping(channel.samples),
          .noise_rms = white_noise_rms(channel.samples)};
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) ==
           std::tolower(static_cast<unsigned char>(y));
  });
}

/// Proposes who is who: by name, else the first two channels that have no name of another role.
class RoleFinder {
 public:
  explicit RoleFinder(const std::vector<ChannelInspection>& channels)
      : channels_(channels), taken_(channels.size(), false) {}

  bool by_name(std::initializer_list<std::string_view> names, RecordedForceOptions& options) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const auto matches = [&](std::string_view name) {
        return same_word(channels_[i].name, name);
      };
      if (!taken_[i] && std::any_of(names.begin(), names.end(), matches)) return take(i, options);
    }
    return false;
  }
  bool next(RecordedForceOptions& options) {
    const auto free = std::find(taken_.begin(), taken_.end(), false);
    if (free == taken_.end()) return false;
    return take(static_cast<std::size_t>(free - taken_.begin()), options);
  }

 private:
  bool take(std::size_t i, RecordedForceOptions& options) {
    taken_[i] = true;
    options.channel = channels_[i].name;
    if (!is_unit_of(channels_[i].unit, "N")) options.calibration = 1.0;
    return true;
  }

  const std::vector<ChannelInspection>& channels_;
  std::vector<bool> taken_;
};

RecordOptions propose(const std::filesystem::path& path, const InspectionOptions& options,
                      const std::vector<ChannelInspection>& channels) {
  RecordOptions record;
  record.file = path.string();
  record.format = options.format;
  record.sample_rate = options.sample_rate;
  RoleFinder roles(channels);
  record.has_reference =
      roles.by_name({"f_c", "fc", "force", "reference", "bow force"}, record.reference);
  record.has_left = roles.by_name({"R1", "R_1", "left"}, record.left);
  record.has_right = roles.by_name({"R2", "R_2", "right"}, record.right);
  const bool named = record.has_left || record.has_right;
  if (!named) {
    record.has_left = roles.next(record.left);
    record.has_right = roles.next(record.right);
  }
  return record;
}

void ask_for_calibrations(InspectionReport& report) {
  const auto ask = [&](bool present, std::string_view role, const RecordedForceOptions& force) {
    if (!present || std::isnan(force.calibration)) return;
    report.warnings.push_back(
        fmt::format("{}: channel {} states no force; fill in record.{}.calibration", report.file,
                    force.channel, role));
  };
  ask(report.record.has_left, "left", report.record.left);
  ask(report.record.has_right, "right", report.record.right);
  ask(report.record.has_reference, "reference", report.record.reference);
}

}  // namespace

InspectionReport inspect(const std::filesystem::path& path, const InspectionOptions& options) {
  Recording recording = survey(path, options);
  InspectionReport report{.file = path.string(),
                          .format = recording.format,
                          .sample_rate = recording.sample_rate,
                          .rate_source = recording.rate_source,
                          .time_jitter = recording.time_jitter,
                          .frames = recording.frames(),
                          .channels = {},
                          .problems = recording.problems,
                          .problem_count = recording.problem_count,
                          .warnings = recording.warnings,
                          .record = {}};
  for (RecordedChannel& channel : recording.channels) {
    report.channels.push_back(inspect_channel(channel));
    channel = {};
  }
  report.record = propose(path, options, report.channels);
  ask_for_calibrations(report);
  return report;
}

}  // namespace modcal
