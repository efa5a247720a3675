// The bow's motion as stretches on which velocity and load are linear in time, and who watches the
// force that it makes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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

/// A stretch of a bow's motion on a time grid; it lasts until the next one starts.
struct BowStretch {
  GridPoint start;
  BowDrive drive;
};
/// At least one; the first starts at the origin. A knot within 1e-9 of a step of a grid point is
/// that point. `knots` with rising times, at least one; `grid_step` [s].
std::vector<BowStretch> stretches_of(const std::vector<BowKnot>& knots, double grid_step);

/// The running grid step, the stretch of the bow's motion it lies in, and the base that τ [s] of
/// adherence, or of a bow in the air, counts from. Position x in [0, 1] of the running grid step.
class BowClock {
 public:
  /// Starts at t = 0. `grid_step` [s].
  BowClock(const std::vector<BowKnot>& knots, double grid_step)
      : path_(stretches_of(knots, grid_step)),
        stretch_(path_.data()),
        last_stretch_(&path_.back()),
        grid_step_(grid_step) {}
  BowClock(const BowClock&) = delete;
  BowClock& operator=(const BowClock&) = delete;

  /// The bow's drive from the start of the stretch.
  const BowDrive& drive() const { return stretch_->drive; }
  /// The bow's drive counted from x.
  BowDrive drive_at(double x) const { return stretch_->drive.from(since(stretch_->start, x)); }
  double time_at(double x) const { return (static_cast<double>(step_) + x) * grid_step_; }

  /// Where the running grid step is cut by the next stretch; 1: not at all.
  double cut() const {
    if (stretch_ == last_stretch_) return 1.0;
    const GridPoint next = (stretch_ + 1)->start;
    return next.step == step_ ? next.x : 1.0;
  }
  /// The next stretch starts within so many grid steps.
  bool cut_within(std::size_t steps) const {
    return stretch_ != last_stretch_ && (stretch_ + 1)->start.step < step_ + steps;
  }

  void enter_stretch() { ++stretch_; }
  void pass(std::size_t steps) { step_ += steps; }

  void mark_base(double x) { base_ = {step_, x}; }
  double since_base(double x) const { return since(base_, x); }

 private:
  double since(GridPoint start, double x) const {
    return (static_cast<double>(step_ - start.step) + (x - start.x)) * grid_step_;
  }

  std::vector<BowStretch> path_;
  const BowStretch* stretch_;  // the running one
  const BowStretch* last_stretch_;
  double grid_step_;
  std::uint64_t step_ = 0;
  GridPoint base_;
};

enum class ContactPhase { kFree, kSliding, kSticking };

/// A stretch of the solution: the force that drove the string on it, f(θ) = Σ_k force[k] θ^k, θ = 1
/// at its end.
struct ForcePiece {
  ContactPhase phase = ContactPhase::kFree;
  double duration = 0.0;          ///< [s]
  std::span<const double> force;  ///< [N]; none: no contact
  BowDrive drive;                 ///< τ = 0 at the start of the piece
  double side = 0.0;              ///< sgn v_c, while sliding
  std::span<const double> rise;   ///< powers of the temperature rise, while sliding [K]
};

/// Pieces follow each other without a gap from t = 0 on.
class ForceObserver {
 public:
  virtual ~ForceObserver() = default;
  virtual void piece(const ForcePiece& piece) = 0;
  /// The string sticks from here on, the spring being stretched by `elongation` [m].
  virtual void attached(double elongation) = 0;
  /// The spring is let go.
  virtual void released() = 0;
};

}  // namespace modcal::event
