#include "experiments/kinds/structure/structure_files.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libsim/base/units.hpp"
#include "libsim/records/formats.hpp"
#include "libsim/records/levels.hpp"
#include "libsim/records/record_keys.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

struct Kind {
  SensorKind kind;
  std::string_view name, unit;
};
constexpr std::array kKinds = {
    Kind{SensorKind::kAcceleration, "acceleration", "m/s2"},
    Kind{SensorKind::kDisplacement, "displacement", "m"}, Kind{SensorKind::kForce, "force", "N"},
    Kind{SensorKind::kStrain, "strain", "1"}, Kind{SensorKind::kVelocity, "velocity", "m/s"}};

// What any sensor's channel has.
template <typename Channel>
void visit_reading(OptionVisitor& visitor, Channel& channel) {
  visitor("calibration", "SI unit per recorded 1; \"file\": the file states a unit, or it is SI",
          {.word = "file"}, channel.calibration);
  visitor("turned", "the sensor reads with the other sign", channel.turned);
}

// SI per recorded 1. A column without a unit is taken to be in SI, which is said.
double scale_of(const StructureChannelOptions& options, const RecordedChannel& channel,
                std::string_view si_unit, std::vector<std::string>& unstated) {
  const double sign = options.turned ? -1.0 : 1.0;
  if (!std::isnan(options.calibration)) return sign * options.calibration;
  if (channel.unit.empty()) {
    unstated.push_back(fmt::format("{} ({})", channel.name, si_unit));
    return sign;
  }
  MODCAL_REQUIRE(is_unit_of(channel.unit, si_unit),
                 "channel {} is in \"{}\", which is no unit of what it is said to be ({}): state "
                 "its kind, or calibration, the {} per recorded 1",
                 channel.name, channel.unit, si_unit, si_unit);
  return sign *
         to_si(std::isfinite(channel.full_scale) ? channel.full_scale : 1.0, channel.unit, si_unit);
}

// Until then no signal has left its level at first by a hundredth of its largest departure. The
// noise that a window taken out has made large is weighted by it again; decay: of a sample.
std::size_t quiet_samples(const std::vector<std::vector<double>>& signals, double decay) {
  std::size_t quiet = signals.front().size();
  for (const std::vector<double>& signal : signals) {
    const std::size_t few = std::min<std::size_t>(5, signal.size());
    double level = 0.0, most = 0.0;
    for (std::size_t j = 0; j < few; ++j) level += signal[j] / static_cast<double>(few);
    for (std::size_t i = 0; i < signal.size(); ++i) {
      const double weight = std::exp(-decay * static_cast<double>(i));
      most = std::max(most, weight * std::abs(signal[i] - level));
    }
    std::size_t j = 0;
    while (j < quiet && std::abs(signal[j] - level) < 0.01 * most) ++j;
    quiet = std::min(quiet, j);
  }
  // A rise is slow at first.
  return quiet * 4 / 5;
}

// Two sensors that read the same are one.
void require_different(const LoadedStructureRecord& loaded, const std::string& file) {
  const auto& responses = loaded.record.responses;
  for (std::size_t k = 1; k < responses.size(); ++k) {
    const auto twin = std::find(responses.begin(),
                                responses.begin() + static_cast<std::ptrdiff_t>(k), responses[k]);
    MODCAL_REQUIRE(
        twin == responses.begin() + static_cast<std::ptrdiff_t>(k),
        "{}: channels {} and {} are the same samples: name the channel of each sensor, or "
        "leave one out",
        file, loaded.names[static_cast<std::size_t>(twin - responses.begin())], loaded.names[k]);
  }
}

// first: sample of the file with which the record begins.
void take_window_out(double window, std::size_t first, StructureRecord& record) {
  if (std::isnan(window)) return;
  const auto take_out = [&](std::vector<double>& signal) {
    for (std::size_t j = 0; j < signal.size(); ++j) {
      signal[j] *= std::exp(static_cast<double>(first + j) / record.sample_rate / window);
    }
  };
  std::ranges::for_each(record.responses, take_out);
  take_out(record.force);
}

void remove_level(const StructureRecordOptions& options, LoadedStructureRecord& loaded) {
  StructureRecord& record = loaded.record;
  // By the responses alone: a force that is only compared with must not change the answer.
  const std::size_t quiet =
      quiet_samples(record.responses, window_decay(options.window) / record.sample_rate);
  const std::size_t count =
      std::isnan(options.rest)
          ? quiet
          : static_cast<std::size_t>(std::llround(options.rest * record.sample_rate));
  MODCAL_REQUIRE(count < record.samples(), "record.rest = {:g} s is all of the record's {:g} s",
                 options.rest, record.duration());
  constexpr std::size_t kFewest = 8;
  if (count < kFewest) return;
  loaded.rest = static_cast<double>(count) / record.sample_rate;
  loaded.quiet = static_cast<double>(std::min(count, quiet)) / record.sample_rate;
  const auto remove_from = [count](std::vector<double>& signal) {
    double mean = 0.0;
    for (std::size_t j = 0; j < count; ++j) mean += signal[j] / static_cast<double>(count);
    for (double& x : signal) x -= mean;
  };
  std::ranges::for_each(record.responses, remove_from);
  if (!record.force.empty()) remove_from(record.force);
}

}  // namespace

std::vector<std::string_view> sensor_kind_names() {
  std::vector<std::string_view> names;
  for (const Kind& kind : kKinds) names.push_back(kind.name);
  return names;
}

SensorKind sensor_kind_of(std::string_view name) {
  return std::ranges::find(kKinds, name, &Kind::name)->kind;
}

std::string_view name_of(SensorKind kind) {
  return std::ranges::find(kKinds, kind, &Kind::kind)->name;
}

std::string_view unit_of(SensorKind kind) {
  return std::ranges::find(kKinds, kind, &Kind::kind)->unit;
}

void StructureForceChannel::visit(OptionVisitor& visitor) {
  visitor("channel", "column or channel of the file, by name or by number from 1",
          {.required = true}, channel);
  visit_reading(visitor, *this);
}

void StructureChannelOptions::visit(OptionVisitor& visitor) {
  visitor("channel", "column or channel of the file, by name or by number from 1",
          {.required = true}, channel);
  visitor("kind", "what the sensor reads", {.choices = sensor_kind_names()}, kind);
  visit_reading(visitor, *this);
}

void StructureRecordOptions::visit(OptionVisitor& visitor) {
  visit_record_file(visitor, *this);
  visitor("responses", "channels of the sensors", {.required = true}, responses);
  visitor("force", "measured force of the strike", has_force, force);
  visit_record_part(visitor, *this);
  visitor("rest",
          "nothing moves so long from the start on: the mean of it is taken out of every channel; "
          "automatic: until a channel leaves its level by 1 % of its largest departure",
          {.unit = "s", .range = Range::non_negative(), .word = "automatic"}, rest);
  visit_exponential_window(visitor, window);
}

void visit_exponential_window(OptionVisitor& visitor, double& window) {
  visitor(
      "exponential_window",
      "time constant by which the instrument has weighted all channels, exp(-t/tau), t from the "
      "file's first sample on: taken out, or every mode would be damped by 1/tau more",
      {.unit = "s", .range = Range::positive(), .word = "none"}, window);
}

double window_decay(double window) { return std::isnan(window) ? 0.0 : 1.0 / window; }

LoadedStructureRecord load_structure_record(const StructureRecordOptions& options,
                                            const std::filesystem::path& folder,
                                            const StopToken& stop) {
  ReadOptions read{.sample_rate = options.sample_rate, .stop = stop};
  for (const StructureChannelOptions& response : options.responses) {
    read.channels.push_back(response.channel);
  }
  if (options.has_force) read.channels.push_back(options.force.channel);
  const Recording recording = read_record(folder / options.file, options.format, read);
  MODCAL_REQUIRE(std::isfinite(recording.sample_rate),
                 "{}: the file does not tell its sample rate: state record.sample_rate",
                 options.file);
  LoadedStructureRecord loaded{.warnings = recording.warnings};
  loaded.record.sample_rate = recording.sample_rate;
  const auto index = [&](double time) {
    return std::min(recording.frames(),
                    static_cast<std::size_t>(std::llround(time * recording.sample_rate)));
  };
  const std::size_t first = index(options.start);
  const std::size_t last = std::isnan(options.stop) ? recording.frames() : index(options.stop);
  MODCAL_REQUIRE(first < last, "{}: no sample lies between record.start = {:g} s and its end",
                 options.file, options.start);
  // A thousandth of a signal is what instruments leave of it at the least.
  const double end = static_cast<double>(last) / recording.sample_rate;
  MODCAL_REQUIRE(end * window_decay(options.window) < 7.0,
                 "{}: at {:g} s the exponential_window of {:g} s has left less than a thousandth: "
                 "state an earlier record.stop or another window",
                 options.file, end, options.window);
  const auto part = [&](std::size_t channel, double scale) {
    std::vector<double> samples(
        recording.channels[channel].samples.begin() + static_cast<std::ptrdiff_t>(first),
        recording.channels[channel].samples.begin() + static_cast<std::ptrdiff_t>(last));
    for (double& x : samples) x *= scale;
    return samples;
  };
  std::vector<std::string> unstated;
  for (std::size_t k = 0; k < options.responses.size(); ++k) {
    const SensorKind kind = sensor_kind_of(options.responses[k].kind);
    loaded.kinds.push_back(kind);
    loaded.names.push_back(recording.channels[k].name);
    require_vibration(recording, recording.channels[k], first, last, options.file);
    loaded.record.responses.push_back(
        part(k, scale_of(options.responses[k], recording.channels[k], unit_of(kind), unstated)));
  }
  require_different(loaded, options.file);
  if (options.has_force) {
    loaded.record.force = part(options.responses.size(),
                               scale_of(options.force, recording.channels.back(), "N", unstated));
  }
  if (!unstated.empty()) {
    loaded.warnings.push_back(fmt::format(
        "no unit is stated of {}: taken to be SI; state calibration where it is another one",
        fmt::join(unstated, ", ")));
  }
  take_window_out(options.window, first, loaded.record);
  remove_level(options, loaded);
  return loaded;
}

void require_whole_blow(const StructureRecord& record, const std::string& file) {
  if (record.force.empty()) return;
  const std::span<const double> force = record.force;
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto largest = std::ranges::max_element(force, smaller);
  const double peak = std::abs(*largest);
  // A tenth of the largest, and no noise.
  std::vector<double> sizes(force.begin(), force.end());
  for (double& size : sizes) size = std::abs(size);
  const double begun = std::max(0.1 * peak, 10.0 * quantile(sizes, 0.5));
  MODCAL_REQUIRE(!(std::abs(force.front()) > begun),
                 "{}: the force begins with {:.3g} N, its largest is {:.3g} N: the record begins "
                 "within the blow, and what moved before is missing; record again with a longer "
                 "time before the trigger",
                 file, force.front(), peak);
  // A round top of which n samples are equal has fallen by at most four steps of the resolution one
  // sample farther, n = 3, and rounding adds one.
  auto first = largest, end = largest;
  while (first != force.begin() && *(first - 1) == *largest) --first;
  while (end != force.end() && *end == *largest) ++end;
  if (end - first < 3 || first == force.begin() || end == force.end()) return;
  const double fall = peak - std::max(std::abs(*(first - 1)), std::abs(*end));
  MODCAL_REQUIRE(
      !(fall > 6.0 * resolution_of(force)),
      "{}: {} samples of the force from {} on are {:.6g} N, its largest: it is clipped, "
      "and all constants would be too large; record again with less gain, or strike less",
      file, end - first, first - force.begin(), *largest);
}

}  // namespace modcal
