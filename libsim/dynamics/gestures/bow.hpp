// The bow stroke as a user describes it, and its motion as the simulators take it.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/dynamics/gestures/gesture_noise.hpp"

namespace modcal {

/// Bow stroke: contact point x_c [m], v_bow(t) = velocity·g_v(t)·(1 + noise) [m/s],
/// F_N(t) = normal_force·g_F(t)·(1 + noise) [N]. Steady unless a gesture or noise is chosen.
struct Bow {
  double position = std::numeric_limits<double>::quiet_NaN();
  double velocity = 0.1;
  double normal_force = 1.0;
  double width = 0.0;       ///< of the hair ribbon along the string [m]
  std::int64_t points = 1;  ///< contact points, evenly spaced over the width
  Choice<Gesture> velocity_gesture{"steady"};
  Choice<Gesture> force_gesture{"steady"};
  GestureNoise velocity_noise;
  GestureNoise force_noise;
  void visit(OptionVisitor& visitor);

  /// The contact points x_c + width ((i + ½)/points − ½) [m], each of which carries an equal share
  /// of force, adherence and friction state.
  std::vector<double> contact_points() const;
};

/// Velocity v_bow(t) [m/s] and normal force F_N(t) ≥ 0 [N] of the bow.
struct BowMotion {
  PiecewiseLinear velocity;
  PiecewiseLinear normal_force;
  bool is_steady() const { return velocity.is_constant() && normal_force.is_constant(); }
};

/// Motion of the bow on [0, duration] [s]. Throws InvalidInput where velocity or force is not
/// finite or the force is negative somewhere.
BowMotion bow_motion(const Bow& bow, double duration);

}  // namespace modcal
