#include "libsim/base/options.hpp"

#include <fmt/format.h>

#include <cmath>

namespace modcal {

bool Range::contains(double value) const {
  if (!std::isfinite(value)) return false;
  const bool above = lowest_allowed ? value >= lowest : value > lowest;
  const bool below = highest_allowed ? value <= highest : value < highest;
  return above && below;
}

std::string Range::text() const {
  const bool has_low = std::isfinite(lowest);
  const bool has_high = std::isfinite(highest);
  if (has_low && has_high) {
    return fmt::format("in {}{:g}, {:g}{}", lowest_allowed ? '[' : '(', lowest, highest,
                       highest_allowed ? ']' : ')');
  }
  if (has_low) return fmt::format("{} {:g}", lowest_allowed ? ">=" : ">", lowest);
  if (has_high) return fmt::format("{} {:g}", highest_allowed ? "<=" : "<", highest);
  return "any finite number";
}

}  // namespace modcal
