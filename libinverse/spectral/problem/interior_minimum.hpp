// The minimum meant on a curve that has many.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace modcal {

/// A local minimum and how far it stands out.
struct InteriorMinimum {
  std::size_t index = 0;
  /// log₁₀ of the lower of the two barriers between the minimum and lower ground (or the end of the
  /// curve) on either side, over the minimum: its topographic prominence in decades.
  double prominence = 0.0;
  std::size_t count = 0;  ///< interior local minima on the whole curve
};

/// The most prominent interior local minimum of positive values, the first of equals. Ends,
/// plateaus that touch them and values that are not positive are no minima. Empty where there is
/// none.
std::optional<InteriorMinimum> most_prominent_minimum(std::span<const double> values);

}  // namespace modcal
