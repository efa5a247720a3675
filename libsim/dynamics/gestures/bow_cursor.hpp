// The bow at the instants of a step loop.
#pragma once

#include "libsim/dynamics/gestures/bow.hpp"

namespace modcal {

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
