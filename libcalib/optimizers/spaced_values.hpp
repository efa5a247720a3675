// Evenly spaced candidates.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace modcal {

/// values_j from low to high in equal steps, both ends exact; at least two values.
inline void space_evenly(double low, double high, std::span<double> values) {
  const auto last = static_cast<double>(values.size() - 1);
  for (std::size_t j = 0; j < values.size(); ++j) {
    values[j] = std::lerp(low, high, static_cast<double>(j) / last);
  }
}

}  // namespace modcal
