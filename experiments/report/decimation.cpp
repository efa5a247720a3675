#include "experiments/report/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace modcal::report {
namespace {

constexpr std::size_t kSamplesPerColumn = 4;

std::vector<std::size_t> columns_of(std::span<const double> x, std::size_t columns,
                                    bool logarithmic) {
  const std::size_t n = x.size();
  std::vector<std::size_t> result(n);
  const bool monotonic = std::is_sorted(x.begin(), x.end()) || std::is_sorted(x.rbegin(), x.rend());
  const auto place = [&](double value) { return logarithmic ? std::log(value) : value; };
  const double start = place(x.front());
  const double width = place(x.back()) - start;
  for (std::size_t i = 0; i < n; ++i) {
    if (monotonic && width != 0.0) {
      const double share = (place(x[i]) - start) / width;
      const auto column = static_cast<std::size_t>(share * static_cast<double>(columns));
      result[i] = std::min(column, columns - 1);
    } else {
      result[i] = i * columns / n;
    }
  }
  return result;
}

// Extremes and one gap of the samples [begin, end) of one column.
void append_column(std::span<const double> low, std::span<const double> high, std::size_t begin,
                   std::size_t end, std::vector<std::size_t>& kept) {
  constexpr auto kNone = static_cast<std::size_t>(-1);
  std::size_t lowest = kNone;
  std::size_t highest = kNone;
  std::size_t gap = kNone;
  for (std::size_t i = begin; i < end; ++i) {
    if (std::isnan(low[i]) || std::isnan(high[i])) {
      gap = i;
      continue;
    }
    if (lowest == kNone || low[i] < low[lowest]) lowest = i;
    if (highest == kNone || high[i] > high[highest]) highest = i;
  }
  for (const std::size_t i : {lowest, highest, gap}) {
    if (i != kNone) kept.push_back(i);
  }
}

}  // namespace

std::vector<std::size_t> drawn_samples(std::span<const double> x, std::span<const double> low,
                                       std::span<const double> high, std::size_t columns,
                                       bool logarithmic) {
  const std::size_t n = x.size();
  std::vector<std::size_t> kept;
  if (n <= kSamplesPerColumn * columns) {
    kept.resize(n);
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  const std::vector<std::size_t> column = columns_of(x, columns, logarithmic);
  kept = {0, n - 1};
  for (std::size_t begin = 0; begin < n;) {
    std::size_t end = begin + 1;
    while (end < n && column[end] == column[begin]) ++end;
    append_column(low, high, begin, end, kept);
    begin = end;
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

}  // namespace modcal::report
