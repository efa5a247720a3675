// An inspection in words, for programs, and as the start of an experiment.
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "experiments/config/help.hpp"
#include "experiments/records/inspection.hpp"
#include "libsim/base/units.hpp"
#include "libsim/model/string_model.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {
namespace {

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

std::string channel_text(const ChannelInspection& channel, bool measured) {
  const Levels& levels = channel.levels;
  std::string result =
      fmt::format("  {} [{}]{}{}\n", channel.name, channel.unit.empty() ? "no unit" : channel.unit,
                  channel.kind.empty() ? "" : ", ", channel.kind);
  if (!measured) return result;
  result += fmt::format(
      "    rms {}, peak {}, std {}, mean (DC) {}\n"
      "    clipping: {}\n",
      number(levels.rms), number(levels.peak), number(levels.std), number(levels.mean),
      text(channel.clipping));
  result += std::isfinite(channel.noise_rms)
                ? fmt::format("    noise: {} rms{}\n", number(channel.noise_rms),
                              levels.std > 0.0 ? fmt::format(" ({:.3g} % of std)",
                                                             100.0 * channel.noise_rms / levels.std)
                                               : "")
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

ordered_json channel_json(const ChannelInspection& channel, bool measured) {
  const Levels& levels = channel.levels;
  ordered_json result = {{"name", channel.name}, {"unit", channel.unit}};
  if (!channel.kind.empty()) result["kind"] = channel.kind;
  if (!measured) return result;
  result.update({{"rms", null_if_unknown(levels.rms)},
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
                 {"noise_rms", null_if_unknown(channel.noise_rms)}});
  return result;
}

constexpr const char* kBand =
    "low:  # from where on the sensors hear the modes, as 10 Hz\n"
    "high:  # to where the blow drives them, as 600 Hz\n";

std::string functions_stanza(const InspectionReport& report) {
  std::string text = fmt::format("kind: fit_modes\nfunctions:\n  file: {}\n  responses:\n",
                                 yaml_string(report.file));
  for (const std::string& name : report.functions->responses) {
    text += fmt::format("    - {{channel: {}}}\n", yaml_string(name));
  }
  return text + kBand;
}

// How its values lie in time, or over frequency.
std::string grid_text(const InspectionReport& report) {
  const std::size_t count = report.channels.size();
  const char* const plural = count == 1 ? "" : "s";
  if (report.functions) {
    return fmt::format("  {} function{} of frequency, {} lines from {:g} to {:g} Hz\n", count,
                       plural, report.frames, report.functions->first, report.functions->last);
  }
  return fmt::format("  {} channel{}, {} samples at {} Hz ({}), {} s\n", count, plural,
                     report.frames, number(report.sample_rate),
                     report.rate_source.empty() ? "not stated" : report.rate_source,
                     number(duration(report)));
}

std::string structure_stanza(const InspectionReport& report) {
  const StructureChannels& found = *report.structure;
  std::string record = fmt::format("record:\n  file: {}\n", yaml_string(report.file));
  if (!std::isfinite(report.sample_rate)) record += "  sample_rate:  # [Hz]\n";
  if (!found.force.empty()) {
    record += fmt::format("  force: {{channel: {}}}\n", yaml_string(found.force));
  }
  record += "  responses:\n";
  for (const auto& [channel, kind] : found.responses) {
    record += fmt::format("    - {{channel: {}, kind: {}}}\n", yaml_string(channel), kind);
  }
  if (found.force.empty()) {
    return "kind: identify_force\ntable:  # modes of this structure, which fit_modes writes\n" +
           record;
  }
  return "kind: fit_modes\n" + record + kBand;
}

}  // namespace

std::string text(const InspectionReport& report) {
  std::string result = fmt::format("{}\n  {}\n{}", report.file, report.format, grid_text(report));
  if (std::isfinite(report.time_jitter)) {
    result += fmt::format(
        "  time column: at most {:.3g} s ({:.3g} sampling periods) off a uniform "
        "grid\n",
        report.time_jitter, report.time_jitter * report.sample_rate);
  }
  for (const ChannelInspection& channel : report.channels) {
    result += channel_text(channel, report.measured);
  }
  result += report.functions ? ""
            : report.measured
                ? fmt::format(
                      "  (noise is taken to be white: its level between {} and {} of the Nyquist "
                      "frequency, extended to all frequencies)\n",
                      kNoiseBandLow, kNoiseBandHigh)
                : "  (headers alone were read; nothing was measured)\n";
  result += list_text("A run would refuse this file:", report.problems, report.problem_count);
  result += list_text("Warnings:", report.warnings, report.warnings.size());
  return result + "\nTo use it in an experiment:\n\n" + stanza(report);
}

ordered_json json(const InspectionReport& report) {
  ordered_json channels = ordered_json::array();
  for (const ChannelInspection& channel : report.channels) {
    channels.push_back(channel_json(channel, report.measured));
  }
  return {{"file", report.file},
          {"format", report.format},
          {"sample_rate", null_if_unknown(report.sample_rate)},
          {"rate_source", report.rate_source},
          {"time_jitter", null_if_unknown(report.time_jitter)},
          {"samples", report.frames},
          {"measured", report.measured},
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
  if (report.functions) return functions_stanza(report);
  if (report.structure) return structure_stanza(report);
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
