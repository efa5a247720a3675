// The section `record` of an experiment, and the signals that it names.
#include <cmath>

#include "libsim/base/units.hpp"
#include "libsim/records/formats.hpp"
#include "libsim/records/levels.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/record_keys.hpp"
#include "libsim/records/recording.hpp"
#include "libsim/signal/measurement.hpp"

namespace modcal {

void require_vibration(const Recording& recording, const RecordedChannel& channel,
                       std::size_t first, std::size_t last, const std::string& file) {
  const auto fault = find_fault(std::span(channel.samples).subspan(first, last - first));
  if (!fault) return;
  const std::size_t sample = first + fault->first;
  throw_invalid_input(
      "{}{}: channel {}, sample {} ({:.6g} s): {}", file,
      recording.lines.empty() ? "" : fmt::format(":{}", recording.lines.line(sample)), channel.name,
      sample, static_cast<double>(sample) / recording.sample_rate, fault->text);
}

namespace {

// What a channel of a record may be.
struct RoleName {
  std::string_view key;
  std::string_view meaning;
  std::string_view quantity;  // of the signal
  std::string_view word;      // "force"
  bool RecordOptions::*present;
  RecordedChannelOptions RecordOptions::*options;
  std::optional<Signal> RecordedSignals::*target;
};
constexpr RoleName kRoles[] = {
    {"left", "reaction at x = 0", "R1", "force", &RecordOptions::has_left, &RecordOptions::left,
     &RecordedSignals::left},
    {"right", "reaction at x = L", "R2", "force", &RecordOptions::has_right, &RecordOptions::right,
     &RecordedSignals::right},
    {"reference", "force at the contact, for scoring only", "f_c", "force",
     &RecordOptions::has_reference, &RecordOptions::reference, &RecordedSignals::reference},
    {"reference_velocity", "velocity of the string at the contact, for scoring only", "v",
     "velocity", &RecordOptions::has_reference_velocity, &RecordOptions::reference_velocity,
     &RecordedSignals::reference_velocity},
    {"reference_displacement", "displacement of the string at the contact, for scoring only", "y",
     "displacement", &RecordOptions::has_reference_displacement,
     &RecordOptions::reference_displacement, &RecordedSignals::reference_displacement},
};

struct Role : RoleName {
  const RecordedChannelOptions& chosen;
};

std::vector<Role> chosen_roles(const RecordOptions& options) {
  MODCAL_REQUIRE(
      options.has_left || options.has_right,
      "the record of {} names no reaction; add left: {{channel: …}} or right: {{channel: "
      "…}}",
      options.file);
  std::vector<Role> roles;
  for (const RoleName& name : kRoles) {
    if (options.*name.present) roles.push_back({name, options.*name.options});
  }
  return roles;
}

// What `work` gives; its InvalidInput is said of the key.
template <typename Work>
auto at_key(const std::string& key, const Work& work) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    throw WrongRecordKey(key, error.what(), error.place());
  }
}

/// What a recorded 1 is in SI units, without the sensor's sign.
double scale_of(const RecordedChannel& channel, const Role& role, const std::string& file) {
  const double calibration = role.chosen.calibration;
  const std::string_view unit = role.chosen.unit;
  const bool is_stated = std::isfinite(channel.full_scale) && is_unit_of(channel.unit, unit);
  if (std::isnan(calibration)) {
    MODCAL_REQUIRE(is_stated,
                   "{}: channel {} {}; state record.{}.calibration, the {} per recorded 1 (for "
                   "CSV per unit of the column, for WAV per full scale)",
                   file, channel.name,
                   channel.unit.empty() ? std::string("has no unit")
                                        : fmt::format("is in \"{}\", which is no unit of {}",
                                                      channel.unit, role.word),
                   role.key, role.word);
    return to_si(channel.full_scale, channel.unit, unit);
  }
  MODCAL_REQUIRE(calibration != 0.0 && std::isfinite(calibration),
                 "record.{}.calibration = {} {} cannot be used: it must not be 0", role.key,
                 calibration, unit);
  MODCAL_REQUIRE(!is_stated,
                 "{}: channel {} is a {} in {} already; leave out record.{}.calibration, or the "
                 "unit in the file",
                 file, channel.name, role.word, channel.unit, role.key);
  return calibration;
}

struct Window {
  std::size_t first;
  std::size_t last;  ///< one behind
};

Window crop_window(const RecordOptions& options, double sample_rate, std::size_t frames,
                   const std::string& file) {
  const double duration = static_cast<double>(frames) / sample_rate;
  const double stop = std::isnan(options.stop) ? duration : options.stop;
  // Half a sample: times printed with few digits still name the end.
  MODCAL_REQUIRE(
      options.start >= 0.0 && options.start < stop && stop <= duration + 0.5 / sample_rate,
      "{}: the part from start = {:g} s to stop = {:g} s is not in the record, which "
      "lasts {:.9g} s",
      file, options.start, stop, duration);
  const auto index = [&](double time) {
    return std::min(frames, static_cast<std::size_t>(std::llround(time * sample_rate)));
  };
  const Window window{index(options.start), index(stop)};
  MODCAL_REQUIRE(window.first < window.last, "{}: no sample lies between {:g} s and {:g} s", file,
                 options.start, stop);
  return window;
}

Signal signal_of(const RecordedChannel& channel, const Role& role, double sample_rate,
                 const Window& window, const std::string& file) {
  const double scale =
      (role.chosen.turned ? -1.0 : 1.0) * at_key(fmt::format("{}.calibration", role.key),
                                                 [&] { return scale_of(channel, role, file); });
  std::vector<double> samples = at_key(fmt::format("{}.delay", role.key), [&] {
    return advanced(channel.samples, role.chosen.delay, sample_rate);
  });
  samples.erase(samples.begin() + static_cast<std::ptrdiff_t>(window.last), samples.end());
  samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(window.first));
  for (double& value : samples) value *= scale;
  return {std::string(role.quantity), std::string(role.chosen.unit), sample_rate,
          std::move(samples)};
}

// What is wrong with the samples of a reaction; few that are clipped are told of.
void judge_samples(const Recording& recording, const RecordedChannel& channel, const Window& window,
                   const std::string& file, bool is_reaction, std::vector<std::string>& warnings) {
  const auto used = std::span(channel.samples).subspan(window.first, window.last - window.first);
  if (is_reaction) require_vibration(recording, channel, window.first, window.last, file);
  const Clipping clipping = find_clipping(used);
  if (clipping.samples == 0) return;
  warnings.push_back(
      fmt::format("{}: channel {}: {}: peaks may be cut; record again with less gain, or crop to a "
                  "part without",
                  file, channel.name, text(clipping)));
}

Recording read_channels(const RecordOptions& options, const std::filesystem::path& path,
                        const std::vector<Role>& roles, const StopToken& stop) {
  std::vector<std::string> channels;
  for (const Role& role : roles) {
    MODCAL_REQUIRE(!role.chosen.channel.empty(), "record.{}.channel is empty; name a channel of {}",
                   role.key, path.string());
    channels.push_back(role.chosen.channel);
  }
  try {
    return read_record(path, options.format,
                       {.channels = channels, .sample_rate = options.sample_rate, .stop = stop});
  } catch (const WrongChannel& error) {
    throw WrongRecordKey(fmt::format("{}.channel", roles[error.place()].key), error.what());
  }
}

}  // namespace

RecordedSignals load_record(const RecordOptions& options, const std::filesystem::path& folder,
                            const StopToken& stop) {
  MODCAL_REQUIRE(!options.file.empty(), "record.file is empty; name the recorded file");
  const std::filesystem::path path = folder / options.file;
  const std::string name = path.string();
  const std::vector<Role> roles = chosen_roles(options);
  const Recording recording = read_channels(options, path, roles, stop);
  if (!recording.contradictions.empty()) {
    throw WrongRecordKey(
        "sample_rate", fmt::format("record.sample_rate is stated and the file contradicts it: {}; "
                                   "leave record.sample_rate out, or correct the file",
                                   recording.contradictions.front()));
  }
  const Window window = at_key(std::isnan(options.stop) ? "start" : "stop", [&] {
    return crop_window(options, recording.sample_rate, recording.frames(), name);
  });
  RecordedSignals signals;
  signals.sample_rate = recording.sample_rate;
  signals.warnings = recording.warnings;
  const std::size_t reactions = (options.has_left ? 1 : 0) + (options.has_right ? 1 : 0);
  for (std::size_t i = 0; i < roles.size(); ++i) {
    at_key(fmt::format("{}.channel", roles[i].key), [&] {
      judge_samples(recording, recording.channels[i], window, name, i < reactions,
                    signals.warnings);
    });
    signals.*roles[i].target =
        signal_of(recording.channels[i], roles[i], recording.sample_rate, window, name);
  }
  return signals;
}

void RecordedChannelOptions::visit(OptionVisitor& visitor) {
  visitor("channel", "column or channel of the file, by name or by number from 1",
          {.required = true}, channel);
  visitor(
      "calibration",
      "what a recorded 1 (CSV) or full scale (WAV) is, negative to turn the sign; \"file\": the "
      "file states the unit",
      {.unit = unit, .word = "file"}, calibration);
  visitor("turned", "the sensor reads with the other sign", turned);
  visitor("delay", "lag behind the other channels; it is shifted back", {.unit = "s"}, delay);
}

void RecordOptions::visit(OptionVisitor& visitor) {
  visit_record_file(visitor, *this);
  for (const RoleName& role : kRoles) {
    visitor(role.key, role.meaning, this->*role.present, this->*role.options);
  }
  visit_record_part(visitor, *this);
}

void ContactOptions::visit(OptionVisitor& visitor) {
  visitor("position", "contact point x_c, from the end x = 0",
          {.unit = "m", .range = Range::positive(), .required = true}, position);
}

}  // namespace modcal
