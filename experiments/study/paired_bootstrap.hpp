// Whether two methods differ, judged on the same draws.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace modcal {

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
