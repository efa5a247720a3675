// A number an optimizer may change.
#pragma once

#include <limits>
#include <string>

namespace modcal {

/// Free variable in the unit a user reads. Optimizers see z = (x − initial)/scale, for which steps
/// of order one are sensible.
struct Variable {
  std::string name;
  std::string unit;
  double initial = std::numeric_limits<double>::quiet_NaN();
  double lower = std::numeric_limits<double>::quiet_NaN();
  double upper = std::numeric_limits<double>::quiet_NaN();
  double scale = 1.0;  ///< > 0
};

}  // namespace modcal
