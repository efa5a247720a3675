// Writes the samples of a run to where they are asked for.
#pragma once

#include <algorithm>
#include <cstddef>

#include "libsim/dynamics/event/modes/motion.hpp"
#include "libsim/dynamics/event/sticking.hpp"
#include "libsim/dynamics/fixed_step/step_loop.hpp"

namespace modcal::event {

/// Signals that nobody asked for are left out.
class SampleWriter {
 public:
  explicit SampleWriter(const SampleTargets& targets) : to_(targets) {}

  MotionRequest wanted() const {
    return {.contact = to_.displacement || to_.velocity,
            .reactions = to_.left_reaction || to_.right_reaction};
  }

  void write(std::size_t sample, const Motion& motion) const {
    if (to_.displacement) to_.displacement[sample] = motion.displacement;
    if (to_.velocity) to_.velocity[sample] = motion.velocity;
    if (to_.force) to_.force[sample] = motion.force;
    if (to_.left_reaction) to_.left_reaction[sample] = motion.left;
    if (to_.right_reaction) to_.right_reaction[sample] = motion.right;
  }
  /// The first `count` steps of a block, from `sample` on.
  void write(std::size_t sample, const Sticking::Block& block, std::size_t count) const {
    const auto copy = [&](const Sticking::Block::Row& row, double* to) {
      if (to == nullptr) return;
      if (count == Sticking::kBlock) {  // known to the compiler: no call
        std::copy_n(row.begin(), Sticking::kBlock, to + sample);
      } else {
        std::copy_n(row.begin(), count, to + sample);
      }
    };
    copy(block.displacement, to_.displacement);
    copy(block.velocity, to_.velocity);
    copy(block.force, to_.force);
    copy(block.left, to_.left_reaction);
    copy(block.right, to_.right_reaction);
  }

 private:
  const SampleTargets& to_;
};

}  // namespace modcal::event
