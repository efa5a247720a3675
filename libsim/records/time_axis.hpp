// Is a column of sampling instants uniform?
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace modcal {

struct TimeFinding {
  std::size_t sample;  ///< index of the sample the finding is about, from 0
  std::string text;
};

struct TimeAxis {
  double sample_rate;  ///< [Hz]; NaN for fewer than two samples or instants that do not increase
  double jitter;       ///< largest deviation from the uniform grid [s]
  std::size_t jitter_sample;
  bool coarse;  ///< not uniform, and printed too coarsely to tell why; the rate is not known then
  std::vector<TimeFinding> findings;
};

/// Compares instants t_i [s], printed to `resolution` [s], with the uniform grid t_0 + i Δt,
/// Δt = (t_{n−1} − t_0)/(n − 1). A step over 1.5 median steps is a gap; a deviation over
/// 0.01 Δt + resolution (printing moves each instant by half its resolution) is jitter. A rate
/// that lies within the printed resolution of a whole number of hertz is that number.
TimeAxis examine_time_axis(std::span<const double> t, double resolution);

}  // namespace modcal
