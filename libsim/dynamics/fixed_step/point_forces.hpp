// The friction forces of several contact points, solved for together.
#pragma once

#include "libsim/dynamics/fixed_step/contact_point.hpp"
#include "libsim/dynamics/fixed_step/line_kernel.hpp"
#include "libsim/dynamics/fixed_step/tuning.hpp"

namespace modcal {

inline double dot(const double* a, const double* b, std::size_t size) {
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) sum += a[i] * b[i];
  return sum;
}

/// Point: CoulombPoint or BristlePoint.
template <typename Point>
class PointForces {
 public:
  explicit PointForces(const DirectResponse& direct) : direct_(direct) {}

  void add(Point point, const BowInstant& bow) {
    force_[points_.size()] = point.initial_force(bow);
    points_.push_back(std::move(point));
  }
  const double* force() const { return force_; }
  const std::vector<Point>& points() const { return points_; }

  /// The forces of points that move as given whatever their forces are.
  void follow(const PointMotions& motion, const BowInstant& bow) {
    for (std::size_t j = 0; j < points_.size(); ++j) {
      points_[j].begin_step();
      points_[j].switch_state(motion.velocity[j], motion.displacement[j], {}, bow);
      force_[j] = points_[j].solve(motion.velocity[j], motion.displacement[j], {}, bow);
    }
  }

  /// The forces of all points, in states that fit them, where `motion` is that without these
  /// forces: all points that must switch under the forces of the others do so together, each once,
  /// and the forces are solved for again. Points in equal positions therefore behave equally. False
  /// where that leaves a point with a force that friction cannot carry: the step is too long to
  /// tell what happened first.
  bool solve(const PointMotions& motion, const BowInstant& bow) {
    for (Point& point : points_) point.begin_step();
    const bool several = points_.size() > 1;
    if (several && !settle(motion, bow)) return false;
    for (std::size_t round = 0; round <= points_.size(); ++round) {
      const bool switched = switch_states(motion, bow);
      if (several && !switched) break;
      if (!settle(motion, bow)) return false;
      if (!several) return true;
    }
    return carried(bow);
  }

  void end_step(double time_step, const PointMotions& motion, const BowInstant& bow) {
    for (std::size_t j = 0; j < points_.size(); ++j) {
      points_[j].end_step(time_step, motion.velocity[j], force_[j], bow);
    }
  }

 private:
  // Motion of point j that the forces of the others leave, its own force apart.
  struct FreeMotion {
    double velocity, displacement;
    PointResponse own;
  };
  FreeMotion free_motion(const PointMotions& motion, std::size_t j) const {
    const PointResponse own{direct_.velocity[j][j], direct_.displacement[j][j]};
    const std::size_t size = points_.size();
    return {motion.velocity[j] + dot(direct_.velocity[j], force_, size) - own.velocity * force_[j],
            motion.displacement[j] + dot(direct_.displacement[j], force_, size) -
                own.displacement * force_[j],
            own};
  }

  bool switch_states(const PointMotions& motion, const BowInstant& bow) {
    bool switched = false;
    for (std::size_t j = 0; j < points_.size(); ++j) {
      const FreeMotion free = free_motion(motion, j);
      switched |= points_[j].switch_state(free.velocity, free.displacement, free.own, bow);
    }
    return switched;
  }

  bool carried(const BowInstant& bow) const {
    for (std::size_t j = 0; j < points_.size(); ++j) {
      if (!points_[j].carries(force_[j], bow)) return false;
    }
    return true;
  }

  // Largest change and largest force of a sweep.
  struct Sweep {
    double change = 0.0, scale = 0.0;
  };
  Sweep sweep(const PointMotions& motion, const BowInstant& bow) {
    Sweep result{.scale = bow.normal_force};
    for (std::size_t j = 0; j < points_.size(); ++j) {
      const FreeMotion free = free_motion(motion, j);
      const double force = points_[j].solve(free.velocity, free.displacement, free.own, bow);
      result.change = std::max(result.change, std::abs(force - force_[j]));
      result.scale = std::max(result.scale, std::abs(force));
      force_[j] = force;
    }
    return result;
  }

  // Gauss–Seidel over the points: a force moves the other points by at most b times it, and b K_a h
  // and b C_a are small where the step resolves the adherence.
  bool settle(const PointMotions& motion, const BowInstant& bow) {
    double previous = HUGE_VAL;
    for (int k = 0; k < kPointSweeps; ++k) {
      const auto [change, scale] = sweep(motion, bow);
      if (points_.size() == 1 || change <= 1e-13 * scale) return true;
      // The stretch of the spring carries the rounding of the displacement, K_a y · 1e-16: where
      // the changes no longer fall they are that.
      if (change <= 1e-8 * scale && change >= 0.5 * previous) return true;
      if (!std::isfinite(change)) return true;  // reported as a motion that is not finite
      previous = change;
    }
    return false;
  }

  const DirectResponse& direct_;
  std::vector<Point> points_;
  double force_[kMostPoints] = {};
};

}  // namespace modcal
