#include "libsim/records/levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libsim/records/tuning.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

using Samples = std::span<const double>;
using Fault = std::optional<SampleFault>;

Fault find_spike(Samples samples) {
  if (samples.size() < kShortestNoiseRecord) return std::nullopt;
  std::vector<double> sorted(samples.begin(), samples.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const auto farther = [median = *middle](double a, double b) {
    return std::abs(a - median) < std::abs(b - median);
  };
  const auto spike = std::max_element(samples.begin(), samples.end(), farther);
  const auto index = static_cast<std::size_t>(spike - samples.begin());
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    // An anti-alias filter spreads a spike over its neighbors.
    if (i + 1 >= index && i <= index + 1) continue;
    lowest = std::min(lowest, samples[i]);
    highest = std::max(highest, samples[i]);
  }
  const double width = highest - lowest;
  if (*spike <= highest + width && *spike >= lowest - width) return std::nullopt;
  // What a sensor reads of a short blow is as high beside its peak. An anti-alias filter makes one
  // neighbor of a spike larger than half of it, and the other one smaller; one at a quarter of the
  // rate or below makes a blow of it, which is not told apart here.
  const auto is_high = [&](std::size_t i) {
    return i < samples.size() && (samples[i] - *middle) / (*spike - *middle) > 0.5;
  };
  if (is_high(index - 1) && is_high(index + 1)) return std::nullopt;
  return SampleFault{index, fmt::format("{:.6g} stands alone, all others lie between {:.6g} and "
                                        "{:.6g}: a spike; repair the sample or crop it away",
                                        *spike, lowest, highest)};
}

/// Samples at an extreme value and at the next one.
struct Pile {
  double value = 0.0, next = 0.0;
  std::size_t at_value = 0, at_next = 0;
};

Pile pile_at(Samples samples, bool highest) {
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
  Pile pile{highest ? *high : *low, highest ? *low : *high};
  for (const double x : samples) {
    if (x != pile.value) pile.next = highest ? std::max(pile.next, x) : std::min(pile.next, x);
  }
  for (const double x : samples) {
    pile.at_value += x == pile.value;
    pile.at_next += x == pile.next;
  }
  return pile;
}

// Whether a pile is so many times as high as one where a signal of few steps turns.
bool is_higher(const Pile& pile, double factor) {
  constexpr double kRoundest = std::numbers::sqrt2 + 1.0;
  return static_cast<double>(pile.at_value) >
         factor * kRoundest * static_cast<double>(pile.at_next);
}

Fault find_clipped(Samples samples) {
  for (const bool highest : {true, false}) {
    const Pile pile = pile_at(samples, highest);
    if (!is_higher(pile, 2.0)) continue;
    std::size_t runs = 0, first = 0;
    for_each_run(samples, [&](const Run& run) {
      if (samples[run.first] != pile.value || run.count < kShortestClip) return;
      if (runs++ == 0) first = run.first;
    });
    if (runs == 0) continue;
    return SampleFault{
        first, fmt::format("{} samples, {} run{} of {} or more, are {:.6g}, the {}, and {} the "
                           "next value {:.6g}: the peaks are clipped; record again with less "
                           "gain, or crop to a part that is not clipped",
                           pile.at_value, runs, runs == 1 ? "" : "s", kShortestClip, pile.value,
                           highest ? "largest" : "smallest", pile.at_next, pile.next)};
  }
  return std::nullopt;
}

// Whether within two steps of the resolution the signal comes and goes, as where it turns, or as
// many samples as the run has stay before or behind it, as in silence.
bool is_signal(Samples samples, const Run& run) {
  const double reach = 2.0 * resolution_of(samples), level = samples[run.first];
  const auto quiet = [&](std::size_t first, std::size_t end) {
    const Samples side = samples.subspan(first, end - first);
    return std::all_of(side.begin(), side.end(),
                       [&](double x) { return std::abs(x - level) <= reach; });
  };
  const auto before = [&](std::size_t count) {
    return quiet(run.first - std::min(run.first, count), run.first);
  };
  const auto behind = [&](std::size_t count) {
    return quiet(run.end(), std::min(samples.size(), run.end() + count));
  };
  return (before(1) && behind(1)) || before(run.count) || behind(run.count);
}

std::size_t count_equal(Samples samples) {
  std::size_t equal = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) equal += samples[i] == samples[i - 1];
  return equal;
}

// Whether chance leaves a run of `count` in one of 10⁹ records, of which so many samples besides
// equal the one before.
bool is_no_chance(std::size_t count, std::size_t equal_besides, double sample_count) {
  const double others = sample_count - static_cast<double>(count);
  const double share = (static_cast<double>(equal_besides) + 1.0) / (others + 1.0);
  const double chance = std::log(sample_count) + static_cast<double>(count - 1) * std::log(share);
  return chance < std::log(1e-9);
}

Fault find_held(Samples samples, double sample_count) {
  const std::size_t equal = count_equal(samples);
  const auto extremes = std::minmax_element(samples.begin(), samples.end());
  Fault fault;
  for_each_run(samples, [&](const Run& run) {
    const double level = samples[run.first];
    const bool extreme = level == *extremes.first || level == *extremes.second;
    if (fault || run.count < kShortestClip || extreme) return;
    if (!is_no_chance(run.count, equal - (run.count - 1), sample_count)) return;
    if (is_signal(samples, run)) return;
    fault = {run.first, fmt::format("{} samples in a row are {:.6g}: a gap that was filled; crop "
                                    "to the part before or behind it",
                                    run.count, level)};
  });
  return fault;
}

// A string that rings out comes to rest within the last steps of the resolution.
Fault find_cut_end(Samples samples, const Run& last) {
  if (last.count < kShortestClip) return std::nullopt;
  const std::size_t equal = count_equal(samples) - (last.count - 1);
  if (!is_no_chance(last.count, equal, static_cast<double>(samples.size()))) return std::nullopt;
  const double level = samples[last.first], reach = 2.0 * resolution_of(samples);
  const std::size_t before = std::min({last.first, last.count, kRingsOut});
  const Samples end = samples.subspan(last.first - before, before);
  const auto is_quiet = [&](double x) { return std::abs(x - level) <= reach; };
  if (std::all_of(end.begin(), end.end(), is_quiet)) return std::nullopt;
  return SampleFault{last.first,
                     fmt::format("all {} samples from here to the end are {:.6g}: the channel was "
                                 "cut off; crop to the part before (record.stop)",
                                 last.count, level)};
}

// Of a force that pushes and then is no more; a signal that is cut at 0 comes back every period,
// and most of its zeros are not in long runs.
bool rests_at_zero(Samples samples) {
  std::size_t zeros = 0, at_rest = 0;
  for_each_run(samples, [&](const Run& run) {
    if (samples[run.first] != 0.0) return;
    zeros += run.count;
    const auto count = static_cast<double>(run.count);
    if (count >= kRestAtZero * static_cast<double>(samples.size())) at_rest += run.count;
  });
  return zeros > 0 &&
         static_cast<double>(at_rest) > (1.0 - kRestAtZero) * static_cast<double>(zeros);
}

}  // namespace

std::optional<SampleFault> find_extreme_magnitude(std::span<const double> samples) {
  const auto magnitude = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto largest = std::max_element(samples.begin(), samples.end(), magnitude);
  const double square = *largest * *largest * static_cast<double>(samples.size());
  if (square >= std::numeric_limits<double>::min() && square < std::numeric_limits<double>::max()) {
    return std::nullopt;
  }
  return SampleFault{
      static_cast<std::size_t>(largest - samples.begin()),
      fmt::format("{:g} is the largest magnitude, whose square is outside the range of double "
                  "precision: no sensor reads that; repair the sample, or state the unit that the "
                  "numbers have",
                  *largest)};
}

Clipping find_clipping(std::span<const double> samples) {
  const Levels levels = measure_levels(samples);
  Clipping clipping{.lowest = levels.lowest, .highest = levels.highest};
  if (!(levels.lowest < levels.highest)) return clipping;
  const bool rests = rests_at_zero(samples);
  const auto is_cut = [&](double level, bool highest) {
    return !(rests && level == 0.0) && is_higher(pile_at(samples, highest), 1.0);
  };
  const bool at_lowest = is_cut(levels.lowest, false);
  const bool at_highest = is_cut(levels.highest, true);
  for_each_run(samples, [&](const Run& run) {
    const double value = samples[run.first];
    const bool extreme =
        (at_lowest && value == levels.lowest) || (at_highest && value == levels.highest);
    if (!extreme || run.count < kShortestClip) return;
    if (clipping.runs++ == 0) clipping.first = run.first;
    clipping.samples += run.count;
  });
  return clipping;
}

std::string text(const Clipping& clipping) {
  if (clipping.samples == 0) return "none";
  return fmt::format(
      "{} samples in {} run{} of {} or more at the limits {:.6g} and {:.6g}, first at "
      "sample {}",
      clipping.samples, clipping.runs, clipping.runs == 1 ? "" : "s", kShortestClip,
      clipping.lowest, clipping.highest, clipping.first);
}

Levels measure_levels(std::span<const double> samples) {
  std::vector<double> finite;
  finite.reserve(samples.size());
  Levels levels{kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, kUnknown, 0, 0};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (std::isfinite(samples[i])) {
      finite.push_back(samples[i]);
    } else if (levels.not_finite++ == 0) {
      levels.first_not_finite = i;
    }
  }
  if (finite.empty()) return levels;
  const auto [low, high] = std::minmax_element(finite.begin(), finite.end());
  levels.lowest = *low;
  levels.highest = *high;
  levels.mean = mean(finite);
  levels.std = standard_deviation(finite);
  levels.rms = std::hypot(levels.mean, levels.std);
  levels.peak = std::max(std::abs(*low), std::abs(*high));
  return levels;
}

double white_noise_rms(std::span<const double> samples) {
  const std::size_t length = samples.size();
  const auto finite = [](double value) { return std::isfinite(value); };
  if (length < kShortestNoiseRecord || !std::all_of(samples.begin(), samples.end(), finite)) {
    return kUnknown;
  }
  const std::vector<Complex> spectrum = hann_spectrum(samples);
  const double half = 0.5 * static_cast<double>(length);
  const auto low = static_cast<std::size_t>(std::ceil(kNoiseBandLow * half));
  const auto high = static_cast<std::size_t>(std::floor(kNoiseBandHigh * half));
  std::vector<double> power;
  for (std::size_t k = low; k <= high; ++k) power.push_back(std::norm(spectrum[k]));
  return std::sqrt(quantile(std::move(power), 0.5) / std::numbers::ln2);
}

double resolution_of(std::span<const double> samples) {
  std::vector<double> sorted(samples.begin(), samples.end());
  std::sort(sorted.begin(), sorted.end());
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i] > sorted[i - 1]) step = std::min(step, sorted[i] - sorted[i - 1]);
  }
  return step;
}

std::optional<SampleFault> find_fault(std::span<const double> samples) {
  if (samples.empty()) return std::nullopt;
  std::size_t first = 1, end = samples.size();
  while (first < end && samples[first] == samples[0]) ++first;
  if (first == end && end > 1) {
    return SampleFault{0, fmt::format("all {} samples are {:g}: the channel is silent; check its "
                                      "sensor, channel and scale, or leave it out",
                                      end, samples[0])};
  }
  while (end > first && samples[end - 1] == samples.back()) --end;
  // The last of the silence before and the first of that behind belong to the signal.
  const Samples signal = samples.subspan(first - 1, std::min(end + 1, samples.size()) - first + 1);
  Fault fault = find_extreme_magnitude(samples);
  if (!fault) fault = find_spike(samples);
  if (fault) return fault;
  fault = find_clipped(signal);
  if (!fault) fault = find_held(signal, static_cast<double>(samples.size()));
  if (fault) fault->first += first - 1;
  if (!fault) fault = find_cut_end(samples, {end, samples.size() - end});
  return fault;
}

}  // namespace modcal
