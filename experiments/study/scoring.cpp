#include "experiments/study/scoring.hpp"

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

void ScoreOptions::visit(OptionVisitor& visitor) {
  visitor.numbers(
      {.key = "windows",
       .meaning = "starts of the windows in which forces are compared; none: the whole record",
       .unit = "s",
       .range = Range::non_negative()},
      windows);
  visitor.number({.key = "periods",
                  .meaning = "length of a window in periods of the fundamental",
                  .unit = "1",
                  .range = Range::positive()},
                 periods);
  visitor.numbers({.key = "whole",
                   .meaning = "start and stop of a long window scored beside the others; none: no "
                              "such score",
                   .unit = "s",
                   .range = Range::non_negative()},
                  whole);
  visitor.integer({.key = "oversampling",
                   .meaning = "rate of the simulated force behind the anti-aliased correlation, in "
                              "sample rates; 1: no such score",
                   .range = Range::closed(1, 64)},
                  oversampling);
}

namespace {

struct Interval {
  double start = 0.0;
  std::size_t first = 0;
  std::size_t length = 0;
};

WindowScore score(std::span<const double> identified, std::span<const double> smooth,
                  const ScoreReference& reference, const Interval& interval) {
  const auto part = [&interval](std::span<const double> samples) {
    return samples.subspan(interval.first, interval.length);
  };
  const std::span<const double> truth = part(reference.truth.samples);
  WindowScore result{.start = interval.start,
                     .correlation = correlation(part(identified), truth),
                     .relative_rms_error = relative_rms_error(part(identified), truth)};
  if (!smooth.empty()) {
    result.anti_aliased = correlation(part(smooth), part(reference.anti_aliased->samples));
  }
  return result;
}

std::vector<double> smooth_estimate(const Signal& identified, const ScoreReference& reference,
                                    std::span<const double> unaliased) {
  if (!reference.anti_aliased) return {};
  const std::span<const double> samples = unaliased.empty() ? identified.samples : unaliased;
  return low_passed(samples, identified.sample_rate, reference.anti_alias_cut);
}

}  // namespace

std::vector<WindowScore> score_windows(const Signal& identified, const ScoreReference& reference,
                                       const ScoreOptions& options,
                                       std::span<const double> unaliased) {
  const Signal& truth = reference.truth;
  const double rate = truth.sample_rate;
  const auto length =
      static_cast<std::size_t>(std::round(options.periods / reference.fundamental * rate));
  const std::vector<double> smooth = smooth_estimate(identified, reference, unaliased);
  std::vector<WindowScore> scores;
  if (options.windows.empty()) {
    scores.push_back(score(identified.samples, smooth, reference, {0.0, 0, truth.size()}));
  }
  for (const double start : options.windows) {
    const auto first = static_cast<std::size_t>(std::round(start * rate));
    MODCAL_REQUIRE(length >= 2 && first + length <= truth.size(),
                   "the score window from {:g} s over {:g} periods ({} samples) is not inside the "
                   "record of {:g} s",
                   start, options.periods, length, truth.duration());
    scores.push_back(score(identified.samples, smooth, reference, {start, first, length}));
  }
  return scores;
}

WindowScore score_whole(const Signal& identified, const ScoreReference& reference,
                        const ScoreOptions& options, std::span<const double> unaliased) {
  if (options.whole.empty()) return {};
  MODCAL_REQUIRE(options.whole.size() == 2, "the long window has {} ends: start and stop are two",
                 options.whole.size());
  const Signal& truth = reference.truth;
  const auto first = static_cast<std::size_t>(std::round(options.whole[0] * truth.sample_rate));
  const auto last = static_cast<std::size_t>(std::round(options.whole[1] * truth.sample_rate));
  MODCAL_REQUIRE(first + 2 <= last && last <= truth.size(),
                 "the long window from {:g} s to {:g} s is not inside the record of {:g} s",
                 options.whole[0], options.whole[1], truth.duration());
  return score(identified.samples, smooth_estimate(identified, reference, unaliased), reference,
               {options.whole[0], first, last - first});
}

std::vector<double> low_passed(std::span<const double> samples, double sample_rate, double cut,
                               std::size_t step) {
  const RealFft fft(samples.size());
  std::vector<Complex> spectrum = fft.forward(samples);
  const double spacing = sample_rate / static_cast<double>(samples.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    if (static_cast<double>(k) * spacing > cut) spectrum[k] = 0.0;
  }
  const std::vector<double> all = fft.inverse(std::move(spectrum));
  std::vector<double> kept;
  kept.reserve(all.size() / step + 1);
  for (std::size_t j = 0; j < all.size(); j += step) kept.push_back(all[j]);
  return kept;
}

}  // namespace modcal
