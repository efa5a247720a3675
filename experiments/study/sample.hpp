// Draws of one quantity, summed up.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "experiments/report/figure.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

/// Values of one quantity over the draws of a setting. Quantiles are type 7 (libsim/signal).
struct Sample {
  std::vector<double> values = {};

  void add(double value) { values.push_back(value); }
  double median() const { return quantile(values, 0.5); }
  double q10() const { return quantile(values, 0.1); }
  double q90() const { return quantile(values, 0.9); }
  /// Mean of what is not NaN; NaN where nothing is.
  double known_mean() const {
    double sum = 0.0;
    std::size_t count = 0;
    for (const double value : values) {
      if (std::isnan(value)) continue;
      sum += value;
      ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Median of a sample with the band from 10 % to 90 % of it; NaN of none.
struct Spread {
  double median = 0.0, q10 = 0.0, q90 = 0.0;
  static Spread of(const Sample& sample) { return {sample.median(), sample.q10(), sample.q90()}; }
};

/// Adds a point with the task that its replay shows; −1: none.
inline void add_task(report::Series& series, double x, double y, std::int64_t task) {
  series.add(x, y);
  series.tasks.push_back(task);
}

/// Adds a point with its band.
inline void add_band(report::Series& series, double x, const Spread& y) {
  series.add(x, y.median, y.q10, y.q90);
}

/// The panel gets the series where it has any point.
inline void add_drawn(report::Panel& panel, report::Series series) {
  if (!series.x.empty()) panel.series.push_back(std::move(series));
}

// Whether two methods differ, judged on the same draws.

/// Ratio of two medians over paired draws with its 95 % interval.
struct MedianRatio {
  std::size_t n = 0;
  double ratio = 1.0;
  double low = 0.0;
  double high = 0.0;

  /// With 95 % confidence, and not from a handful of draws.
  bool is_below_one() const { return n >= 5 && high < 1.0; }
  bool is_above_one() const { return n >= 5 && low > 1.0; }
};

/// Median of a over median of b, of losses > 0 (a draw without a result: 1e300, worse than any);
/// interval by a paired bootstrap of 1000 resamples with a fixed seed (Efron and Tibshirani, 1993,
/// chapter 13). Throws InvalidInput where the lengths differ or are 0.
MedianRatio median_ratio(std::span<const double> a, std::span<const double> b);

/// Medians of some draws and of their resamples. The resamples are the same for all who have as
/// many draws: many methods are resampled once each, not once a pair.
struct BootstrapMedians {
  /// Throws InvalidInput where there are no draws.
  explicit BootstrapMedians(std::span<const double> draws);

  std::size_t n = 0;
  double all = 0.0;
  std::vector<double> resampled;
};
/// The same of draws that stand in the same order. Throws InvalidInput where the numbers differ.
MedianRatio median_ratio(const BootstrapMedians& a, const BootstrapMedians& b);

}  // namespace modcal
