#include "experiments/study/whole_record.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>

#include "libsim/base/error.hpp"
#include "libsim/records/band_edge.hpp"
#include "libsim/records/levels.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {
namespace {

// Samples before the first that differs from the very first.
std::size_t silent_start(std::span<const double> samples) {
  const auto moved = std::ranges::find_if(samples, [&](double x) { return x != samples[0]; });
  return static_cast<std::size_t>(moved - samples.begin());
}

// Whether a part of a reaction swings by so much of what the whole does that its resolution shows
// it and noise is less.
bool is_playing(std::span<const double> part, std::span<const double> whole) {
  constexpr double kPlaying = 0.25;
  if (part.empty()) return false;
  const auto [low, high] = std::ranges::minmax(part);
  const auto [lowest, highest] = std::ranges::minmax(whole);
  return high - low > kPlaying * (highest - lowest);
}

// Whether so few values occur that a moving string may read as one of them for long.
bool is_coarse(std::span<const double> samples) {
  constexpr std::size_t kFewest = 32;
  std::set<double> values;
  for (const double x : samples) {
    if (values.insert(x).second && values.size() > kFewest) return false;
  }
  return true;
}

}  // namespace

void require_whole_beginning(const ObservationOptions& options, const RecordedSignals& signals) {
  const std::span<const double> reactions[] = {signals.left->samples, signals.right->samples};
  const std::size_t silent[] = {silent_start(reactions[0]), silent_start(reactions[1])};
  const std::size_t late = silent[0] > silent[1] ? 0 : 1;
  const std::span<const double> first = reactions[1 - late], last = reactions[late];
  if (is_coarse(last)) return;
  const double period = signals.sample_rate / options.string.fundamental;
  const RecordOptions& record = options.record;
  const std::string* names[] = {&record.left.channel, &record.right.channel};
  const double end = record.start + static_cast<double>(silent[late]) / signals.sample_rate;
  if (static_cast<double>(silent[late] - silent[1 - late]) > period) {
    MODCAL_REQUIRE(!is_playing(first.first(silent[late]), first),
                   "{}: channel {} is {:.6g} up to {:.6g} s, while channel {} reads a string that "
                   "moves: the channel was not connected yet, or was filled; crop to the part "
                   "behind (record.start)",
                   record.file, *names[late], last[0], end, *names[1 - late]);
    return;
  }
  if (silent[1 - late] < kShortestClip || silent[late] - silent[1 - late] > 1) return;
  const double apart = std::abs(1.0 - 2.0 * options.contact.position / options.string.length);
  const std::size_t count =
      std::min(static_cast<std::size_t>(0.4 * apart * period), last.size() - silent[late]);
  MODCAL_REQUIRE(
      !is_playing(first.subspan(silent[late], count), first) ||
          !is_playing(last.subspan(silent[late], count), last),
      "{}: channels {} and {} are {:.6g} and {:.6g} up to {:.6g} s and read a string that "
      "moves from there on: the beginning was filled; crop to the part behind "
      "(record.start)",
      record.file, *names[0], *names[1], reactions[0][0], reactions[1][0], end);
}

void require_whole_band(const RecordOptions& record, const RecordedSignals& signals) {
  for (const End end : kEnds) {
    const Signal& reaction = end == End::kLeft ? *signals.left : *signals.right;
    const std::optional<BandEdge> edge = find_band_edge(reaction.samples);
    if (!edge) continue;
    const double highest = edge->from * signals.sample_rate;
    throw_invalid_input(
        "{}: channel {} is empty above {:.4g} Hz, with {:.1g} of the power just below: a low-pass, "
        "a "
        "lossy format or a resampling took out what was there, and the noise with it, by which the "
        "answers are weighed; use the record as it was before, or resample it to {:.4g} Hz or less",
        record.file, end == End::kLeft ? record.left.channel : record.right.channel, highest,
        edge->share, 2.0 * highest);
  }
}

}  // namespace modcal
