#include "experiments/records/inspection.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "experiments/config/help.hpp"
#include "libsim/base/units.hpp"
#include "libsim/model/string_model.hpp"
#include "libsim/records/formats.hpp"

namespace modcal {
namespace {

// Reading and measuring so many bytes takes about a second.
constexpr std::uintmax_t kMeasuredBytes = 1 << 28;

ChannelInspection inspect_channel(RecordedChannel& channel) {
  const bool scaled = std::isfinite(channel.full_scale);
  if (channel.samples.empty()) {
    return {channel.name, channel.kind, scaled ? channel.unit : "full scale", {}, {}, 0.0, {}};
  }
  if (scaled && channel.full_scale != 1.0) {
    for (double& value : channel.samples) value *= channel.full_scale;
  }
  const Levels levels = measure_levels(channel.samples);
  return {.name = channel.name,
          .kind = channel.kind,
          .unit = scaled ? channel.unit : "full scale",
          .levels = levels,
          .clipping = find_clipping(channel.samples),
          .noise_rms = white_noise_rms(channel.samples),
          .fault = levels.not_finite == 0 ? find_fault(channel.samples) : std::nullopt};
}

// A hammer's force and what it sets in motion; or what moves alone.
std::optional<StructureChannels> structure_of(const std::vector<ChannelInspection>& channels,
                                              const RecordOptions& record) {
  constexpr std::pair<const char*, std::string_view> kMotions[] = {
      {"m/s2", "acceleration"}, {"m/s", "velocity"}, {"m", "displacement"}};
  StructureChannels found;
  std::size_t forces = 0, motions = 0;
  for (const ChannelInspection& channel : channels) {
    const bool moves = is_unit_of(channel.unit, "m/s2") || is_unit_of(channel.unit, "m/s");
    motions += moves ? 1 : 0;
    if (is_unit_of(channel.unit, "N")) {
      found.force = channel.name;
      ++forces;
    }
    for (const auto& [unit, kind] : kMotions) {
      if (is_unit_of(channel.unit, unit)) found.responses.push_back({channel.name, kind});
    }
  }
  // One force beside a displacement, or the velocity of a contact, may be a string's end.
  const bool is_end = forces > motions || record.has_reference_velocity;
  const bool is_string = (record.has_left && record.has_right) || (forces == 1 && is_end);
  if (is_string || forces > 1 || found.responses.empty()) return std::nullopt;
  return found;
}

void ask_for_calibrations(InspectionReport& report) {
  const auto ask = [&](bool present, std::string_view role, const RecordedChannelOptions& force) {
    if (!present || std::isnan(force.calibration)) return;
    report.warnings.push_back(
        fmt::format("{}: channel {} states no force; fill in record.{}.calibration", report.file,
                    force.channel, role));
  };
  ask(report.record.has_left, "left", report.record.left);
  ask(report.record.has_right, "right", report.record.right);
  ask(report.record.has_reference, "reference", report.record.reference);
}

// Two sensors that read the same, sample for sample, are one twice.
void list_copies(const Recording& recording, InspectionReport& report) {
  if (!report.measured) return;
  std::vector<std::string> sensors;
  const RecordOptions& record = report.record;
  if (report.structure) {
    for (const auto& [channel, kind] : report.structure->responses) sensors.push_back(channel);
  } else if (record.has_left && record.has_right) {
    sensors = {record.left.channel, record.right.channel};
  }
  const auto samples_of = [&recording](const std::string& name) -> const std::vector<double>* {
    const auto found = std::ranges::find(recording.channels, name, &RecordedChannel::name);
    return found == recording.channels.end() || found->samples.empty() ? nullptr : &found->samples;
  };
  for (std::size_t k = 1; k < sensors.size(); ++k) {
    const std::vector<double>* const own = samples_of(sensors[k]);
    const auto twin =
        std::find_if(sensors.begin(), sensors.begin() + static_cast<std::ptrdiff_t>(k),
                     [&](const std::string& name) {
                       const std::vector<double>* const other = samples_of(name);
                       return own != nullptr && other != nullptr && *own == *other;
                     });
    if (twin == sensors.begin() + static_cast<std::ptrdiff_t>(k)) continue;
    report.problems.push_back(
        fmt::format("{}: channels {} and {} are one signal, sample for sample: give each {} a "
                    "sensor and a channel of its own, or leave one of them out",
                    report.file, *twin, sensors[k], report.structure ? "place" : "end"));
    ++report.problem_count;
  }
}

// Of a stated rate; a run refuses them.
void list_contradictions(const Recording& recording, InspectionReport& report) {
  for (const std::string& text : recording.contradictions) {
    std::erase(report.warnings, text);
    report.problems.push_back(
        fmt::format("{}; leave the stated rate out, or correct the file", text));
    ++report.problem_count;
  }
}

void list_faults(InspectionReport& report) {
  for (const ChannelInspection& channel : report.channels) {
    const RecordOptions& record = report.record;
    const bool is_reaction = (record.has_left && record.left.channel == channel.name) ||
                             (record.has_right && record.right.channel == channel.name);
    const bool is_response =
        report.structure && std::ranges::any_of(report.structure->responses, [&](const auto& own) {
          return own.channel == channel.name;
        });
    if (!(report.structure ? is_response : is_reaction) || !channel.fault) continue;
    report.problems.push_back(fmt::format("{}: channel {}, sample {}: {}", report.file,
                                          channel.name, channel.fault->first, channel.fault->text));
    ++report.problem_count;
  }
}

// Whether it holds functions of frequency and no record in time; a file that cannot be read is told
// of as a record is.
bool holds_functions(const std::filesystem::path& path, const InspectionOptions& options) {
  try {
    return std::isnan(options.sample_rate) &&
           has_functions_alone(path, options.format, options.memory);
  } catch (const InvalidInput&) {
    return false;
  }
}

InspectionReport inspect_functions(const std::filesystem::path& path,
                                   const InspectionOptions& options) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const FileFunctions all = read_functions(path, options.format);
  InspectionReport report{.file = path.string(),
                          .format = std::string(record_format(path, options.format).meaning),
                          .sample_rate = kUnknown,
                          .rate_source = {},
                          .time_jitter = kUnknown,
                          .frames = all.functions.front().hertz.size(),
                          .measured = false,
                          .channels = {},
                          .problems = {},
                          .problem_count = 0,
                          .warnings = all.warnings,
                          .record = {}};
  const std::vector<double>& hertz = all.functions.front().hertz;
  report.functions = {.responses = {}, .first = hertz.front(), .last = hertz.back()};
  for (const FileFunction& function : all.functions) {
    report.channels.push_back({.name = function.name,
                               .kind = std::string(text_of(function.what)),
                               .unit = function.whole_unit(),
                               .levels = {},
                               .clipping = {},
                               .noise_rms = kUnknown,
                               .fault = {}});
    if (function.what == FrequencyFunction::kResponse) {
      report.functions->responses.push_back(function.name);
    }
  }
  return report;
}

}  // namespace

InspectionReport inspect(const std::filesystem::path& path, const InspectionOptions& options) {
  // A recording in memory is no file.
  std::error_code unreadable;
  const bool large = std::filesystem::file_size(path, unreadable) > kMeasuredBytes && !unreadable;
  const bool headers_only = !unreadable && (large || options.headers_only);
  if (!unreadable && !headers_only && holds_functions(path, options)) {
    return inspect_functions(path, options);
  }
  Recording recording = read_record(path, options.format,
                                    {.sample_rate = options.sample_rate,
                                     .survey = true,
                                     .headers_only = headers_only,
                                     .memory = options.memory});
  InspectionReport report{.file = path.string(),
                          .format = recording.format,
                          .sample_rate = recording.sample_rate,
                          .rate_source = recording.rate_source,
                          .time_jitter = recording.time_jitter,
                          .frames = recording.frames(),
                          .measured = !headers_only,
                          .channels = {},
                          .problems = recording.problems,
                          .problem_count = recording.problem_count,
                          .warnings = recording.warnings,
                          .record = {}};
  for (RecordedChannel& channel : recording.channels) {
    report.channels.push_back(inspect_channel(channel));
  }
  report.record = proposed_roles(path, options, report.channels, report.warnings);
  report.structure = structure_of(report.channels, report.record);
  if (!report.structure) ask_for_calibrations(report);
  list_contradictions(recording, report);
  list_faults(report);
  if (report.problem_count == 0) list_copies(recording, report);
  return report;
}

}  // namespace modcal
