// Bow gestures: how velocity and normal force of the bow go with time.
#pragma once

#include <string_view>

#include "libsim/base/registry.hpp"
#include "libsim/dynamics/gestures/piecewise_linear.hpp"

namespace modcal {

/// Factor g(t) [1] by which a bow's nominal velocity or normal force is multiplied. Every gesture
/// reduces to a piecewise-linear function; 0 lifts the bow (force) or halts it (velocity), a
/// negative factor reverses its velocity.
class Gesture {
 public:
  static constexpr std::string_view kKind = "gesture";
  static Registry<Gesture> registry();

  virtual ~Gesture() = default;
  /// g on [0, duration], duration > 0 [s].
  PiecewiseLinear over(double duration) const;

 private:
  virtual PiecewiseLinear factor(double duration) const = 0;
};

}  // namespace modcal
