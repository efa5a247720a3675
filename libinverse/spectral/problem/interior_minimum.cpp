#include "libinverse/spectral/problem/interior_minimum.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {
namespace {

// Highest value met on the way from `index` in direction `step` before lower ground or the end.
double barrier(std::span<const double> values, std::size_t index, std::ptrdiff_t step) {
  const auto size = static_cast<std::ptrdiff_t>(values.size());
  double highest = values[index];
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(index) + step; i >= 0 && i < size;
       i += step) {
    const double value = values[static_cast<std::size_t>(i)];
    if (value < values[index]) break;
    highest = std::max(highest, value);
  }
  return highest;
}

}  // namespace

std::optional<InteriorMinimum> most_prominent_minimum(std::span<const double> values) {
  std::optional<InteriorMinimum> best;
  std::size_t count = 0;
  for (std::size_t begin = 1; begin + 1 < values.size(); ++begin) {
    if (!(values[begin] > 0.0) || !(values[begin - 1] > values[begin])) continue;
    std::size_t end = begin + 1;  // behind the plateau
    while (end < values.size() && values[end] == values[begin]) ++end;
    if (end == values.size() || !(values[end] > values[begin])) continue;
    ++count;
    const double saddle = std::min(barrier(values, begin, -1), barrier(values, end - 1, +1));
    const double prominence = std::log10(saddle / values[begin]);
    const std::size_t middle = (begin + end - 1) / 2;
    if (!best || prominence > best->prominence) best = InteriorMinimum{middle, prominence, 0};
  }
  if (best) best->count = count;
  return best;
}

}  // namespace modcal
