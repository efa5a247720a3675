// What the contact and the ends of the string do at one instant.
#pragma once

namespace modcal::event {

struct Motion {
  double displacement = 0.0;  ///< y(x_c) [m]
  double velocity = 0.0;      ///< v(x_c) [m/s]
  double force = 0.0;         ///< f_c [N]
  double left = 0.0;          ///< R₁ [N]
  double right = 0.0;         ///< R₂ [N]
};

/// What of a motion is needed beside the force.
struct MotionRequest {
  bool contact = true;
  bool reactions = true;
};

}  // namespace modcal::event
