#include "experiments/study/scoring.hpp"

#include <cmath>

#include "libsim/base/error.hpp"
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
}

std::vector<WindowScore> score_windows(const Signal& identified, const Signal& truth,
                                       const ScoreOptions& options, double fundamental) {
  const double rate = truth.sample_rate;
  const auto length = static_cast<std::size_t>(std::round(options.periods / fundamental * rate));
  std::vector<WindowScore> scores;
  if (options.windows.empty()) {
    scores.push_back({0.0, correlation(identified.samples, truth.samples),
                      relative_rms_error(identified.samples, truth.samples)});
  }
  for (const double start : options.windows) {
    const auto first = static_cast<std::size_t>(std::round(start * rate));
    MODCAL_REQUIRE(length >= 2 && first + length <= truth.size(),
                   "the score window from {:g} s over {:g} periods ({} samples) is not inside the "
                   "record of {:g} s",
                   start, options.periods, length, truth.duration());
    const std::span<const double> x(identified.samples.data() + first, length);
    const std::span<const double> y(truth.samples.data() + first, length);
    scores.push_back({start, correlation(x, y), relative_rms_error(x, y)});
  }
  return scores;
}

}  // namespace modcal
