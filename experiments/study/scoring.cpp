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

void WindowScore::visit(ResultVisitor& visitor) const {
  visitor({.key = "window_start", .name = "window from", .unit = "s"}, known(start));
  visitor({.key = "correlation", .name = "correlation R"}, known(correlation));
  visitor({.key = "relative_rms_error", .name = "relative rms error"}, known(relative_rms_error));
  visitor({.key = "anti_aliased", .name = "R, anti-aliased"}, known(anti_aliased));
}

std::string WindowScore::text() const {
  return fmt::format("window from {:g} s: R = {:.4f}, relative rms error {:.4f}", start,
                     correlation, relative_rms_error);
}

ForceScores score_force(std::span<const double> identified, const ScoreReference& reference,
                        const ScoreOptions& options, std::span<const double> unaliased) {
  const Signal& truth = reference.truth;
  const double rate = truth.sample_rate;
  std::vector<double> smooth;
  if (reference.anti_aliased) {
    smooth = low_passed(unaliased.empty() ? identified : unaliased, rate, reference.anti_alias_cut);
  }
  const auto place = [rate](double time) {
    return static_cast<std::size_t>(std::round(time * rate));
  };
  const auto score = [&](double start, std::size_t length) {
    const auto part = [first = place(start), length](std::span<const double> samples) {
      return samples.subspan(first, length);
    };
    const std::span<const double> exact = part(truth.samples);
    WindowScore result{.start = start,
                       .correlation = correlation(part(identified), exact),
                       .relative_rms_error = relative_rms_error(part(identified), exact)};
    if (!smooth.empty()) {
      result.anti_aliased = correlation(part(smooth), part(reference.anti_aliased->samples));
    }
    return result;
  };

  ForceScores found;
  const std::size_t length = place(options.periods / reference.fundamental);
  if (options.windows.empty()) found.scores.push_back(score(0.0, truth.size()));
  for (const double start : options.windows) {
    MODCAL_REQUIRE(length >= 2 && place(start) + length <= truth.size(),
                   "the score window from {:g} s over {:g} periods ({} samples) is not inside the "
                   "record of {:g} s",
                   start, options.periods, length, truth.duration());
    found.scores.push_back(score(start, length));
  }
  if (options.whole.empty()) return found;
  MODCAL_REQUIRE(options.whole.size() == 2, "the long window has {} ends: start and stop are two",
                 options.whole.size());
  const std::size_t first = place(options.whole[0]), last = place(options.whole[1]);
  MODCAL_REQUIRE(first + 2 <= last && last <= truth.size(),
                 "the long window from {:g} s to {:g} s is not inside the record of {:g} s",
                 options.whole[0], options.whole[1], truth.duration());
  found.whole = score(options.whole[0], last - first);
  return found;
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
