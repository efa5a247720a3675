// The bow stroke as a user describes it, and its motion as the simulators take it.
#pragma once

#include "libsim/dynamics/gestures/gesture.hpp"

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
  /// Velocity and force: what a contact of any structure has as well.
  void visit_levels(OptionVisitor& visitor);
  /// How they change in time.
  void visit_course(OptionVisitor& visitor);

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

/// Velocity, travel since t = 0 and normal force of the bow at one instant.
struct BowInstant {
  double velocity = 0.0;      ///< v_bow [m/s]
  double travel = 0.0;        ///< ∫ v_bow dt [m]
  double normal_force = 0.0;  ///< F_N [N]
};

/// Evaluates a motion at times that never go back, without a search.
class BowCursor {
 public:
  explicit BowCursor(const BowMotion& motion)
      : velocity_(motion.velocity), force_(motion.normal_force) {}

  BowInstant at(double t) {
    velocity_.go_to(t);
    force_.go_to(t);
    const double since = t - velocity_.start;
    return {.velocity = velocity_.value + velocity_.slope * since,
            .travel = velocity_.travel + since * (velocity_.value + 0.5 * velocity_.slope * since),
            .normal_force = force_.value + force_.slope * (t - force_.start)};
  }

 private:
  // The straight piece that holds the present time.
  struct Piece {
    explicit Piece(const PiecewiseLinear& f) : function(&f) { enter(0.0); }
    void enter(double t) {
      start = t;
      value = function->at(t);
      slope = function->slope(t);
      travel = function->integral(t);
      end = function->next_knot(t);
    }
    void go_to(double t) {
      while (t >= end) enter(end);
    }
    const PiecewiseLinear* function;
    double start = 0.0, end = 0.0, value = 0.0, slope = 0.0, travel = 0.0;
  };
  Piece velocity_, force_;
};

}  // namespace modcal
