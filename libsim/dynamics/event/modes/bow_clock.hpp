// Where a run stands on the time grid and in the motion of its bow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libsim/dynamics/event/modes/bow_path.hpp"

namespace modcal::event {

/// The running grid step, the stretch of the bow's motion it lies in, and the base that τ [s] of
/// adherence, or of a bow in the air, counts from. Position x in [0, 1] of the running grid step.
class BowClock {
 public:
  /// Starts at t = 0. `grid_step` [s].
  BowClock(const std::vector<BowKnot>& knots, double grid_step)
      : path_(knots, grid_step),
        stretch_(path_.stretches().data()),
        last_stretch_(stretch_ + path_.stretches().size() - 1),
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

  BowPath path_;
  const BowPath::Stretch* stretch_;  // the running one
  const BowPath::Stretch* last_stretch_;
  double grid_step_;
  std::uint64_t step_ = 0;
  GridPoint base_;
};

}  // namespace modcal::event
