#include "experiments/records/inspection.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "experiments/config/help.hpp"
#include "libsim/base/units.hpp"
#include "libsim/model/string_model.hpp"
#include "libsim/records/record_file.hpp"

namespace modcal {
namespace {

ChannelInspection inspect_channel(RecordedChannel& channel) {
  const bool scaled = std::isfinite(channel.full_scale);
  if (scaled && channel.full_scale != 1.0) {
    for (double& value : channel.samples) value *= channel.full_scale;
  }
  const Levels levels = measure_levels(channel.samples);
  return {.name = channel.name,
          .unit = scaled ? channel.unit : "full scale",
          .levels = levels,
          .clipping = find_clipping(channel.samples),
          .noise_rms = white_noise_rms(channel.samples),
          .fault = levels.not_finite == 0 ? find_fault(channel.samples) : std::nullopt};
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

void list_faults(InspectionReport& report) {
  for (const ChannelInspection& channel : report.channels) {
    const RecordOptions& record = report.record;
    const bool is_reaction = (record.has_left && record.left.channel == channel.name) ||
                             (record.has_right && record.right.channel == channel.name);
    if (!is_reaction || !channel.fault) continue;
    report.problems.push_back(fmt::format("{}: channel {}, sample {}: {}", report.file,
                                          channel.name, channel.fault->first, channel.fault->text));
    ++report.problem_count;
  }
}

using nlohmann::ordered_json;

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "unknown";
}

ordered_json null_if_unknown(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

double duration(const InspectionReport& report) {
  return static_cast<double>(report.frames) / report.sample_rate;
}

std::string channel_text(const ChannelInspection& channel) {
  const Levels& levels = channel.levels;
  std::string result = fmt::format(
      "  {} [{}]\n"
      "    rms {}, peak {}, std {}, mean (DC) {}\n"
      "    clipping: {}\n",
      channel.name, channel.unit.empty() ? "no unit" : channel.unit, number(levels.rms),
      number(levels.peak), number(levels.std), number(levels.mean), text(channel.clipping));
  result += std::isfinite(channel.noise_rms)
                ? fmt::format("    noise: {} rms ({:.3g} % of std)\n", number(channel.noise_rms),
                              100.0 * channel.noise_rms / levels.std)
                : "    noise: unknown (too few samples, or some are missing)\n";
  if (levels.not_finite > 0) {
    result += fmt::format("    {} samples are no numbers, first sample {}\n", levels.not_finite,
                          levels.first_not_finite);
  }
  return result;
}

std::string list_text(std::string_view title, const std::vector<std::string>& lines,
                      std::size_t count) {
  if (lines.empty()) return {};
  std::string result = fmt::format("{}\n", title);
  for (const std::string& line : lines) result += fmt::format("  {}\n", line);
  if (count > lines.size()) result += fmt::format("  … and {} more\n", count - lines.size());
  return result;
}

ordered_json channel_json(const ChannelInspection& channel) {
  const Levels& levels = channel.levels;
  return {{"name", channel.name},
          {"unit", channel.unit},
          {"rms", null_if_unknown(levels.rms)},
          {"peak", null_if_unknown(levels.peak)},
          {"std", null_if_unknown(levels.std)},
          {"mean", null_if_unknown(levels.mean)},
          {"lowest", null_if_unknown(levels.lowest)},
          {"highest", null_if_unknown(levels.highest)},
          {"not_finite", levels.not_finite},
          {"clipping",
           {{"runs", channel.clipping.runs},
            {"samples", channel.clipping.samples},
            {"first", channel.clipping.first}}},
          {"noise_rms", null_if_unknown(channel.noise_rms)}};
}

}  // namespace

InspectionReport inspect(const std::filesystem::path& path, const InspectionOptions& options) {
  Recording recording =
      read_record(path, options.format, {.sample_rate = options.sample_rate, .survey = true});
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
  list_faults(report);
  return report;
}

std::string text(const InspectionReport& report) {
  std::string result = fmt::format(
      "{}\n  {}\n  {} channel{}, {} samples at {} Hz ({}), {} s\n", report.file, report.format,
      report.channels.size(), report.channels.size() == 1 ? "" : "s", report.frames,
      number(report.sample_rate), report.rate_source.empty() ? "not stated" : report.rate_source,
      number(duration(report)));
  if (std::isfinite(report.time_jitter)) {
    result += fmt::format(
        "  time column: at most {:.3g} s ({:.3g} sampling periods) off a uniform "
        "grid\n",
        report.time_jitter, report.time_jitter * report.sample_rate);
  }
  for (const ChannelInspection& channel : report.channels) result += channel_text(channel);
  result += fmt::format(
      "  (noise is taken to be white: its level between {} and {} of the Nyquist "
      "frequency, extended to all frequencies)\n",
      kNoiseBandLow, kNoiseBandHigh);
  result += list_text("A run would refuse this file:", report.problems, report.problem_count);
  result += list_text("Warnings:", report.warnings, report.warnings.size());
  return result + "\nTo use it in an experiment:\n\n" + stanza(report);
}

ordered_json json(const InspectionReport& report) {
  ordered_json channels = ordered_json::array();
  for (const ChannelInspection& channel : report.channels) {
    channels.push_back(channel_json(channel));
  }
  return {{"file", report.file},
          {"format", report.format},
          {"sample_rate", null_if_unknown(report.sample_rate)},
          {"rate_source", report.rate_source},
          {"time_jitter", null_if_unknown(report.time_jitter)},
          {"samples", report.frames},
          {"duration", null_if_unknown(duration(report))},
          {"channels", channels},
          {"noise_assumption", "white"},
          {"noise_band_of_nyquist", {kNoiseBandLow, kNoiseBandHigh}},
          {"problems", report.problems},
          {"problem_count", report.problem_count},
          {"warnings", report.warnings},
          {"stanza", stanza(report)}};
}

std::string stanza(const InspectionReport& report) {
  RecordOptions record = report.record;
  StringModel string{.modes = 0};
  ContactOptions bow;
  ResolvedWriter writer;
  writer("record", "recorded forces", record);
  writer("string", "the string", string);
  writer("bow", "where the force acts", bow);
  return "kind: invert\n" + writer.yaml();
}

}  // namespace modcal
