#include "libsim/records/levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "libsim/records/runs.hpp"
#include "libsim/signal/hann.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Clipping find_clipping(std::span<const double> samples) {
  const Levels levels = measure_levels(samples);
  Clipping clipping{.lowest = levels.lowest, .highest = levels.highest};
  if (!(levels.lowest < levels.highest)) return clipping;
  for_each_run(samples, [&](const Run& run) {
    const double value = samples[run.first];
    const bool extreme = value == levels.lowest || value == levels.highest;
    if (!extreme || run.count < Clipping::kShortestRun) return;
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
      clipping.samples, clipping.runs, clipping.runs == 1 ? "" : "s", Clipping::kShortestRun,
      clipping.lowest, clipping.highest, clipping.first);
}

Levels measure_levels(std::span<const double> samples) {
  std::vector<double> finite;
  finite.reserve(samples.size());
  Levels levels{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, 0, 0};
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
    return kNaN;
  }
  const std::vector<Complex> spectrum = hann_spectrum(samples);
  const double half = 0.5 * static_cast<double>(length);
  const auto low = static_cast<std::size_t>(std::ceil(kNoiseBandLow * half));
  const auto high = static_cast<std::size_t>(std::floor(kNoiseBandHigh * half));
  std::vector<double> power;
  for (std::size_t k = low; k <= high; ++k) power.push_back(std::norm(spectrum[k]));
  return std::sqrt(quantile(std::move(power), 0.5) / std::numbers::ln2);
}

}  // namespace modcal
