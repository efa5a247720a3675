// The string, its gestures and its grid.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "benchmarks/truth/truth.hpp"

namespace modcal::truth {

double TruthString::bending() const {
  const double width = length / std::numbers::pi;
  return inharmonicity * tension() * width * width;
}

double value_at(const Course& course, double time) {
  if (time <= course.front().time) return course.front().value;
  for (std::size_t i = 1; i < course.size(); ++i) {
    if (time >= course[i].time) continue;
    const Knot &a = course[i - 1], &b = course[i];
    return a.value + (b.value - a.value) * (time - a.time) / (b.time - a.time);
  }
  return course.back().value;
}

WaveGrid grid_of(const TruthString& string, const TruthOptions& options) {
  if (!(options.sample_rate > 0.0) || !(options.least_rate > 0.0)) {
    throw std::invalid_argument("rates must be > 0");
  }
  const double multiple = std::ceil(options.least_rate / (8.0 * options.sample_rate) - 1e-9);
  std::size_t intervals = options.intervals;
  if (intervals == 0) {
    // n f₀ √(1 + B n²) = f_s/2.
    const double part = 0.5 * options.sample_rate / string.fundamental, b = string.inharmonicity;
    const double square =
        b > 0.0 ? (std::sqrt(1.0 + 4.0 * b * part * part) - 1.0) / (2.0 * b) : part * part;
    intervals =
        std::max<std::size_t>(128, static_cast<std::size_t>(std::ceil(3.0 * std::sqrt(square))));
  }
  return {.intervals = intervals,
          .time_step = 1.0 / (8.0 * multiple * options.sample_rate),
          .half_width = options.half_width,
          .loss_half_width = options.half_width / 2};
}

}  // namespace modcal::truth
