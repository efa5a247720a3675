#pragma once

#include <limits>
#include <vector>

namespace modcal {

/// A change between sliding and sticking.
struct Switch {
  double time = 0.0;          ///< [s]
  double displacement = 0.0;  ///< y(x_c) there [m]
  bool attaches = false;      ///< from sliding to sticking
};

/// Takes the switches from a time on; by default none.
struct SwitchList {
  std::vector<Switch>* switches = nullptr;
  double from = std::numeric_limits<double>::infinity();  ///< [s]

  void add(const Switch& change) const {
    if (change.time >= from && switches != nullptr) switches->push_back(change);
  }
};

}  // namespace modcal
