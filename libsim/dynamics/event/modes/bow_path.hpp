// The bow's motion as stretches on which velocity and load are linear in time.
#pragma once

#include <cstdint>
#include <vector>

namespace modcal::event {

/// Velocity v_b [m/s] and load, the factor [1] of friction law and static limit, at a time [s]:
/// both linear between knots and constant before the first and after the last.
struct BowKnot {
  double time = 0.0;
  double velocity = 0.0;
  double load = 1.0;
};

/// v_b + a τ and load + rate τ, τ ≥ 0 [s].
struct BowDrive {
  double velocity = 0.0;
  double acceleration = 0.0;  ///< [m/s²]
  double load = 1.0;
  double load_rate = 0.0;  ///< [1/s]

  double velocity_at(double tau) const { return velocity + acceleration * tau; }
  /// Not below 0, where rounding would put a load that ends there.
  double load_at(double tau) const {
    const double value = load + load_rate * tau;
    return value > 0.0 ? value : 0.0;
  }
  /// ∫ v_b dτ [m].
  double travel(double tau) const { return (velocity + 0.5 * acceleration * tau) * tau; }
  /// The drive whose τ = 0 is this one's τ.
  BowDrive from(double tau) const {
    return {velocity_at(tau), acceleration, load_at(tau), load_rate};
  }
  /// No contact on all of the stretch.
  bool lifted() const { return load <= 0.0 && load_rate <= 0.0; }
};

/// A point of the time grid, x in [0, 1) of a step behind its start.
struct GridPoint {
  std::uint64_t step = 0;
  double x = 0.0;
};

/// Stretches of a bow's motion on a time grid. A knot within 1e-9 of a step of a grid point is
/// that point.
class BowPath {
 public:
  struct Stretch {
    GridPoint start;
    BowDrive drive;
  };
  /// `knots` with rising times, at least one; `grid_step` [s].
  BowPath(const std::vector<BowKnot>& knots, double grid_step);

  /// At least one; the first starts at the origin, each lasts until the next one starts.
  const std::vector<Stretch>& stretches() const { return stretches_; }

 private:
  std::vector<Stretch> stretches_;
};

}  // namespace modcal::event
