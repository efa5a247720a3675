#pragma once

namespace modcal {

/// A change between sliding and sticking.
struct Switch {
  double time = 0.0;          ///< [s]
  double displacement = 0.0;  ///< y(x_c) there [m]
  bool attaches = false;      ///< from sliding to sticking
};

}  // namespace modcal
