#include "libsim/records/stored_channels.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/tuning.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

double period_of(const StoredChannel& channel) {
  return std::isnan(channel.sample_rate) ? channel.period : 1.0 / channel.sample_rate;
}

// Beginnings are compared by the sampling period; where nobody tells it they must be equal.
bool same_grid(const StoredChannel& a, const StoredChannel& b, const ReadOptions& options) {
  const double known = period_of(a);
  const double period = std::isnan(known) ? 1.0 / options.sample_rate : known;
  const bool are_unknown = std::isnan(a.sample_rate) && std::isnan(b.sample_rate);
  // Over all samples, as instants tell it.
  const double drift = std::abs(period_of(b) - known) * static_cast<double>(a.size);
  const bool same_rate =
      a.sample_rate == b.sample_rate || (are_unknown && !(drift > kSameInstant * known));
  const double same = std::isnan(period) ? 0.0 : kSameInstant * period;
  const bool is_later = std::abs(a.start - b.start) > same;
  return same_rate && a.size == b.size && !is_later;
}

// Where channels have instants of their own, these tell when each begins.
void find_beginnings(std::vector<StoredChannel>& stored, const ReadOptions& options) {
  struct Begin {
    double start = std::numeric_limits<double>::quiet_NaN();
    double period = std::numeric_limits<double>::quiet_NaN();
  };
  const auto is_open = [](const StoredChannel& channel) {
    return channel.read_times && std::isnan(channel.start);
  };
  std::map<std::string, Begin> known;
  for (const StoredChannel& channel : stored) {
    if (is_open(channel)) known[channel.times_name] = {};
  }
  if (known.size() < 2 || options.headers_only) return;
  known.clear();
  for (StoredChannel& channel : stored) {
    if (!is_open(channel)) continue;
    const auto [place, is_new] = known.try_emplace(channel.times_name);
    if (is_new) {
      options.stop.throw_if_requested();
      const std::vector<double> times = channel.read_times();
      if (times.size() > 1) {
        place->second = {times.front(),
                         (times.back() - times.front()) / static_cast<double>(times.size() - 1)};
      }
    }
    channel.start = place->second.start;
    channel.period = place->second.period;
  }
}

// What is asked for, or all that can stand in one record with the first channel in time.
std::vector<std::size_t> choose(const std::vector<StoredChannel>& stored,
                                const std::vector<std::string>& names, const ReadOptions& options,
                                const std::string& file, Recording& recording) {
  std::vector<std::size_t> chosen = find_channels(names, options.channels, file);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const StoredChannel& channel = stored[chosen[i]];
    if (channel.other_than_time.empty() && same_grid(channel, stored[chosen[0]], options)) continue;
    throw WrongChannel(
        i, channel.other_than_time.empty()
               ? fmt::format("{}: channel \"{}\" has {}, \"{}\" has {}; one record needs one rate, "
                             "one length and one beginning: crop them to the same instants",
                             file, names[chosen[i]], grid_text(channel), names[chosen[0]],
                             grid_text(stored[chosen[0]]))
               : fmt::format("{}: channel \"{}\" is no record in time but a {}", file,
                             names[chosen[i]], channel.other_than_time));
  }
  if (!options.channels.empty()) return chosen;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const bool fits = stored[i].other_than_time.empty() &&
                      (chosen.empty() || same_grid(stored[i], stored[chosen[0]], options));
    if (fits) {
      chosen.push_back(i);
    } else {
      recording.warnings.push_back(fmt::format("{}: \"{}\" [{}] is left out: {}", file, names[i],
                                               stored[i].head.unit, grid_text(stored[i])));
    }
  }
  return chosen;
}

void use_times(const StoredChannel& channel, const ReadOptions& options, const std::string& file,
               Recording& recording) {
  const std::vector<double> times = channel.read_times();
  const auto finite = [](double value) { return std::isfinite(value); };
  MODCAL_REQUIRE(std::all_of(times.begin(), times.end(), finite),
                 "{}: an instant of \"{}\" is no number", file, channel.head.name);
  const double resolution = channel.time_resolution * largest_magnitude(times);
  const TimeAxis axis = examine_time_axis(times, resolution);
  recording.time_jitter = axis.jitter;
  if (std::isnan(channel.start) && !times.empty()) recording.start = times.front();
  if (!channel.is_rate_stated) {
    recording.sample_rate = axis.sample_rate;
  } else if (axis.findings.empty() && std::isnan(options.sample_rate) &&
             std::abs(axis.sample_rate / channel.sample_rate - 1.0) >
                 std::min(axis.rate_error, kCalibratedClock) + kSameRate) {
    recording.add_problem(fmt::format(
        "{}: {} says {:.9g} Hz, the instants of \"{}\" say {:.9g} Hz; correct one of them or state "
        "sample_rate",
        file, channel.rate_source, channel.sample_rate, channel.head.name, axis.sample_rate));
  }
  if (axis.coarse && !channel.is_rate_stated && std::isnan(options.sample_rate)) {
    recording.add_problem(fmt::format(
        "{}: {}", file,
        too_coarse_text(fmt::format("the time of \"{}\"", channel.head.name), resolution)));
  }
  for (const TimeFinding& finding : axis.findings) {
    std::string text = fmt::format("{}: sample {}: {}", file, finding.sample, finding.text);
    recording.tell_of_instants(std::move(text), finding.breaks, !std::isnan(options.sample_rate));
  }
}

void settle_rate(const StoredChannel& channel, const ReadOptions& options, const std::string& file,
                 Recording& recording) {
  const bool given = std::isfinite(options.sample_rate);
  MODCAL_REQUIRE(std::isnan(options.sample_rate) || (given && options.sample_rate > 0.0),
                 "sample_rate = {} Hz cannot be used: it must be > 0", options.sample_rate);
  recording.sample_rate = channel.sample_rate;
  recording.rate_source = channel.rate_source;
  if (std::isfinite(channel.start)) recording.start = channel.start;
  const bool has_times = channel.read_times && !options.headers_only;
  if (has_times) use_times(channel, options, file, recording);
  if (std::abs(recording.start) > kLatestStart) recording.start = 0.0;
  if (!channel.contradiction.empty() && !given) {
    recording.add_problem(fmt::format("{}: {}; correct one of them or state sample_rate", file,
                                      channel.contradiction));
  }
  if (given) {
    const double rounding = has_times ? 0.0 : channel.rate_rounding;
    if (rounding > 0.0 && std::isnan(recording.sample_rate)) {
      recording.sample_rate = 1.0 / channel.period;
    }
    recording.compare_rate(options.sample_rate, rounding, file);
  } else if (!std::isfinite(recording.sample_rate) && !options.headers_only &&
             recording.problem_count == 0) {
    recording.add_problem(fmt::format("{}: {}", file,
                                      channel.rate_doubt.empty()
                                          ? "the sample rate is not known; state sample_rate"
                                          : channel.rate_doubt));
  } else if (!channel.rate_doubt.empty() && !has_times) {
    recording.warnings.push_back(fmt::format("{}: {}", file, channel.rate_doubt));
  }
}

}  // namespace

std::string grid_text(const StoredChannel& channel) {
  if (!channel.other_than_time.empty()) return channel.other_than_time;
  const double period = period_of(channel);
  const std::string rate = std::isnan(period) ? std::string("a rate that is not stated")
                                              : fmt::format("{:.9g} Hz", 1.0 / period);
  const bool begins_later = std::abs(channel.start) > 0.0;
  return fmt::format("{} samples at {}{}", channel.size, rate,
                     begins_later ? fmt::format(" from {:.9g} s on", channel.start) : "");
}

std::vector<std::string> different_names(const std::vector<StoredChannel>& stored) {
  std::vector<std::string> names;
  for (const StoredChannel& channel : stored) {
    const std::string plain =
        channel.head.name.empty() ? fmt::format("{}", names.size() + 1) : channel.head.name;
    std::string name = plain;
    for (int i = 2; std::find(names.begin(), names.end(), name) != names.end(); ++i) {
      name = fmt::format("{} ({})", plain, i);
    }
    names.push_back(name);
  }
  return names;
}

Recording assemble(std::string format, std::vector<StoredChannel> stored,
                   const ReadOptions& options, const std::string& file) {
  const std::vector<std::string> names = different_names(stored);
  find_beginnings(stored, options);
  Recording recording;
  recording.format = std::move(format);
  const std::vector<std::size_t> chosen = choose(stored, names, options, file, recording);
  if (chosen.empty()) {
    recording.add_problem(fmt::format("{}: no channel of it is a record in time: \"{}\" is a {}",
                                      file, names.front(), grid_text(stored.front())));
  } else {
    settle_rate(stored[chosen[0]], options, file, recording);
    recording.stated_frames = stored[chosen[0]].size;
  }
  for (const std::size_t index : chosen) {
    StoredChannel& channel = stored[index];
    channel.head.name = names[index];
    options.stop.throw_if_requested();
    if (!options.headers_only) channel.head.samples = channel.read();
    for (std::size_t i = 0; i < channel.head.samples.size(); ++i) {
      if (std::isfinite(channel.head.samples[i])) continue;
      recording.add_problem(fmt::format(
          "{}: sample {} of channel {} is {}; repair it, or keep only what stands before or behind "
          "it",
          channel.place.empty() ? file : channel.place, i, names[index], channel.head.samples[i]));
    }
    recording.channels.push_back(std::move(channel.head));
  }
  if (!options.survey) recording.refuse_problems();
  return recording;
}

}  // namespace modcal
