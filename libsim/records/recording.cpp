#include "libsim/records/recording.hpp"

#include <cctype>
#include <charconv>
#include <cmath>

#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/levels.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/tuning.hpp"
#include "libsim/signal/measurement.hpp"

namespace modcal {

namespace {

std::size_t find_channel(const std::vector<std::string>& names, std::string_view text,
                         std::string_view where) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = error == std::errc() && end == text.data() + text.size();
  if (is_number && number >= 1 && number <= names.size()) return number - 1;
  const std::string nearest = nearest_name(text, names);
  throw_invalid_input("{}: there is no channel \"{}\"{}; the file has {} channel{}: {}", where,
                      text, nearest.empty() ? "" : fmt::format(", did you mean \"{}\"?", nearest),
                      names.size(), names.size() == 1 ? "" : "s", fmt::join(names, ", "));
}

struct Role {
  const RecordedForceOptions* options;
  std::string_view key;
  std::string_view quantity;
  std::optional<Signal> RecordedSignals::*target;
};

std::vector<Role> chosen_roles(const RecordOptions& options) {
  MODCAL_REQUIRE(
      options.has_left || options.has_right,
      "the record of {} names no reaction; add left: {{channel: …}} or right: {{channel: "
      "…}}",
      options.file);
  std::vector<Role> roles;
  if (options.has_left) roles.push_back({&options.left, "left", "R1", &RecordedSignals::left});
  if (options.has_right) roles.push_back({&options.right, "right", "R2", &RecordedSignals::right});
  if (options.has_reference) {
    roles.push_back({&options.reference, "reference", "f_c", &RecordedSignals::reference});
  }
  return roles;
}

// What `work` gives; its InvalidInput is said of the key.
template <typename Work>
auto at_key(const std::string& key, const Work& work) {
  try {
    return work();
  } catch (const InvalidInput& error) {
    throw WrongRecordKey(key, error.what());
  }
}

/// Newtons per recorded 1, without the sensor's sign.
double newtons(const RecordedChannel& channel, const Role& role, const std::string& file) {
  const double calibration = role.options->calibration;
  const bool states_force = std::isfinite(channel.full_scale) && is_unit_of(channel.unit, "N");
  if (std::isnan(calibration)) {
    MODCAL_REQUIRE(states_force,
                   "{}: channel {} {}; state record.{}.calibration, the force per recorded 1 (for "
                   "CSV per unit of the column, for WAV per full scale)",
                   file, channel.name,
                   channel.unit.empty()
                       ? std::string("has no unit")
                       : fmt::format("is in \"{}\", which is no unit of force", channel.unit),
                   role.key);
    return to_si(channel.full_scale, channel.unit, "N");
  }
  MODCAL_REQUIRE(calibration != 0.0 && std::isfinite(calibration),
                 "record.{}.calibration = {} N cannot be used: it must not be 0", role.key,
                 calibration);
  MODCAL_REQUIRE(!states_force,
                 "{}: channel {} is a force in {} already; leave out record.{}.calibration, or the "
                 "unit in the file",
                 file, channel.name, channel.unit, role.key);
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

Signal force_signal(const RecordedChannel& channel, const Role& role, double sample_rate,
                    const Window& window, const std::string& file) {
  const double scale =
      (role.options->turned ? -1.0 : 1.0) *
      at_key(fmt::format("{}.calibration", role.key), [&] { return newtons(channel, role, file); });
  std::vector<double> samples = advanced(channel.samples, role.options->delay, sample_rate);
  samples.erase(samples.begin() + static_cast<std::ptrdiff_t>(window.last), samples.end());
  samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(window.first));
  for (double& value : samples) value *= scale;
  return {std::string(role.quantity), "N", sample_rate, std::move(samples)};
}

// What is wrong with the samples of a reaction; few that are clipped are told of.
void judge_samples(const Recording& recording, const RecordedChannel& channel, const Window& window,
                   const std::string& file, bool is_reaction, std::vector<std::string>& warnings) {
  const auto used = std::span(channel.samples).subspan(window.first, window.last - window.first);
  if (const auto fault = is_reaction ? find_fault(used) : std::nullopt) {
    const std::size_t sample = window.first + fault->first;
    throw_invalid_input(
        "{}{}: channel {}, sample {} ({:.6g} s): {}", file,
        recording.lines.empty() ? "" : fmt::format(":{}", recording.lines.line(sample)),
        channel.name, sample, static_cast<double>(sample) / recording.sample_rate, fault->text);
  }
  const Clipping clipping = find_clipping(used);
  if (clipping.samples == 0) return;
  warnings.push_back(fmt::format("{}: channel {}: {}", file, channel.name, text(clipping)));
}

Recording read_channels(const RecordOptions& options, const std::filesystem::path& path,
                        const std::vector<Role>& roles) {
  std::vector<std::string> channels;
  for (const Role& role : roles) {
    MODCAL_REQUIRE(!role.options->channel.empty(),
                   "record.{}.channel is empty; name a channel of {}", role.key, path.string());
    channels.push_back(role.options->channel);
  }
  try {
    return read_record(path, options.format,
                       {.channels = channels, .sample_rate = options.sample_rate});
  } catch (const WrongChannel& error) {
    throw WrongRecordKey(fmt::format("{}.channel", roles[error.place()].key), error.what());
  }
}

}  // namespace

void Recording::add_problem(std::string text) {
  if (problem_count++ < kMaxProblems) problems.push_back(std::move(text));
}

void Recording::contradict(std::string text) {
  contradictions.push_back(text);
  warnings.push_back(std::move(text));
}

void Recording::compare_rate(double stated, double rounding, std::string_view file) {
  const double difference = std::abs(sample_rate / stated - 1.0);
  if (difference > rounding) {
    std::string text = fmt::format("{}: the file says {:.9g} Hz, the stated {:.9g} Hz is used",
                                   file, sample_rate, stated);
    if (difference > kCalibratedClock) contradictions.push_back(text);
    warnings.push_back(std::move(text));
  }
  sample_rate = stated;
  rate_source = "as stated by the user";
}

void SampleLines::add(std::size_t sample, std::size_t line) {
  if (starts_.empty() || line - sample != starts_.back().second - starts_.back().first) {
    starts_.emplace_back(sample, line);
  }
}

std::size_t SampleLines::line(std::size_t sample) const {
  auto after = std::upper_bound(starts_.begin(), starts_.end(), sample,
                                [](std::size_t s, const auto& start) { return s < start.first; });
  --after;
  return after->second + sample - after->first;
}

void Recording::refuse_problems() const {
  if (problem_count == 0) return;
  std::string text = fmt::format("{}", fmt::join(problems, "\n"));
  if (problem_count > problems.size()) {
    text += fmt::format("\n… and {} more of this file", problem_count - problems.size());
  }
  throw InvalidInput(text);
}

std::vector<std::size_t> find_channels(const std::vector<std::string>& names,
                                       const std::vector<std::string>& wanted,
                                       std::string_view where) {
  std::vector<std::size_t> result;
  for (const std::string& text : wanted) try {
      const std::size_t index = find_channel(names, text, where);
      MODCAL_REQUIRE(std::find(result.begin(), result.end(), index) == result.end(),
                     "{}: channel \"{}\" is asked for twice; give every role a channel of its own",
                     where, names[index]);
      result.push_back(index);
    } catch (const InvalidInput& error) {
      throw WrongChannel(result.size(), error.what());
    }
  return result;
}

Recording read_record(const std::filesystem::path& path, const std::string& format,
                      const ReadOptions& options) {
  if (format == "csv") return read_csv(path, options);
  if (format == "wav") return read_wav(path, options);
  MODCAL_REQUIRE(format == "auto", "unknown format \"{}\" of a record: auto, csv or wav", format);
  std::string extension = path.extension().string();
  for (char& letter : extension) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  for (const char* known : {".csv", ".tsv", ".txt"}) {
    if (extension == known) return read_csv(path, options);
  }
  for (const char* known : {".wav", ".wave", ".rf64", ".bwf", ".w64"}) {
    if (extension == known) return read_wav(path, options);
  }
  throw_invalid_input("{}: the extension \"{}\" does not tell the format; state format: csv or wav",
                      path.string(), extension);
}

RecordedSignals load_record(const RecordOptions& options, const std::filesystem::path& folder) {
  MODCAL_REQUIRE(!options.file.empty(), "record.file is empty; name the recorded file");
  const std::filesystem::path path = folder / options.file;
  const std::string name = path.string();
  const std::vector<Role> roles = chosen_roles(options);
  const Recording recording = read_channels(options, path, roles);
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
  for (std::size_t i = 0; i < roles.size(); ++i) {
    judge_samples(recording, recording.channels[i], window, name,
                  roles[i].target != &RecordedSignals::reference, signals.warnings);
    signals.*roles[i].target =
        force_signal(recording.channels[i], roles[i], recording.sample_rate, window, name);
  }
  return signals;
}

void RecordedForceOptions::visit(OptionVisitor& visitor) {
  visitor("channel", "column or channel of the file, by name or by number from 1",
          {.required = true}, channel);
  visitor("calibration",
          "force per unit of the column (CSV) or per full scale (WAV), negative "
          "to turn the sign; \"file\": the file states a unit of force",
          {.unit = "N", .word = "file"}, calibration);
  visitor("turned", "the sensor reads the force with the other sign", turned);
  visitor("delay", "lag behind the other channels; it is shifted back", {.unit = "s"}, delay);
}

void RecordOptions::visit(OptionVisitor& visitor) {
  visitor("file", "recorded file, relative to the folder of the experiment's file",
          {.required = true}, file);
  visitor("format", "format of the file; auto: by its extension",
          {.choices = {"auto", "csv", "wav"}}, format);
  visitor("sample_rate", "sample rate; \"file\": the file states it",
          {.unit = "Hz", .range = Range::positive(), .word = "file"}, sample_rate);
  const auto force = [&visitor](std::string_view key, std::string_view meaning, bool& present,
                                RecordedForceOptions& options) {
    visitor(key, meaning, present, options);
  };
  force("left", "reaction at x = 0", has_left, left);
  force("right", "reaction at x = L", has_right, right);
  force("reference", "force at the contact, for scoring only", has_reference, reference);
  visitor("start", "begin of the part that is used, after the first sample",
          {.unit = "s", .range = Range::non_negative()}, start);
  visitor("stop", "end of the part that is used, after the first sample",
          {.unit = "s", .range = Range::positive(), .word = "end"}, stop);
}

void ContactOptions::visit(OptionVisitor& visitor) {
  visitor("position", "contact point x_c, from the end x = 0",
          {.unit = "m", .range = Range::positive(), .required = true}, position);
}

}  // namespace modcal
