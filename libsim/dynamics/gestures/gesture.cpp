#include "libsim/dynamics/gestures/gesture.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

PiecewiseLinear Gesture::over(double duration) const {
  MODCAL_REQUIRE(duration > 0.0 && std::isfinite(duration),
                 "a gesture over {:g} s: the duration must be > 0", duration);
  return factor(duration);
}

}  // namespace modcal
