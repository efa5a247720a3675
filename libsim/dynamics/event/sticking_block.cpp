// Some steps of the held string at once.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "libsim/dynamics/event/sticking.hpp"

namespace modcal::event {

void Sticking::fill_block() {
  block_ = PlanarRows((kBlockVelocity + rows()) * kBlock, loop_.roots);
  for (std::size_t k = 0; k < kBlock; ++k) {
    block_factor_[k] = loop_.propagator(static_cast<double>(k + 1) * longest_step_);
    for (std::size_t j = 0; j < loop_.roots; ++j) {
      const std::complex<double> factor = block_factor_[k].at(j);
      block_.set(kBlockForce * kBlock + k, j, factor);
      block_.set(kBlockRate * kBlock + k, j, loop_.pole.at(j) * factor);
      for (std::size_t r = 0; r < rows(); ++r) {
        const std::complex<double> weight{loop_.observed.re(r)[j], loop_.observed.im(r)[j]};
        block_.set((kBlockVelocity + r) * kBlock + k, j, weight * factor);
      }
    }
  }
}

// hull_inside() for the steps of a block side by side.
std::size_t Sticking::certified_steps(double tau, const BlockForce& force) const {
  Block::Row start, end, excess;
  for (std::size_t k = 0; k < kBlock; ++k) {
    const Limit at = limit(tau + static_cast<double>(k) * longest_step_, longest_step_);
    start[k] = at.start;
    end[k] = at.end;
  }
  for (std::size_t k = 0; k < kBlock; ++k) {
    const double fall = (end[k] - start[k]) * (1.0 / 3.0);
    const double first = std::abs(force.value[k]) - start[k];
    const double second = std::abs(force.value[k] + force.reach[k]) - (start[k] + fall);
    const double third = std::abs(force.value[k + 1] - force.reach[k + 1]) - (end[k] - fall);
    const double last = std::abs(force.value[k + 1]) - end[k];
    excess[k] = std::max(std::max(first, second), std::max(third, last));
  }
  const double square = longest_step_ * longest_step_;
  const double remainder = square * square * (fourth_derivative_ * (1.0 / 384.0));
  std::size_t steps = 0;
  while (steps < kBlock && excess[steps] + remainder < 0.0 &&
         std::isfinite(force.value[steps + 1])) {
    ++steps;
  }
  return steps;
}

std::size_t Sticking::advance_block(double tau, Block& out) {
  if (starts_at_upper_ || starts_at_lower_) return 0;
  std::array<double, kBlockRows * kBlock> sums{};
  real_products(block_, state_, std::span(sums).first(block_.count));
  BlockForce force;
  Block::Row rate;
  const double part = longest_step_ * (1.0 / 3.0);
  force.value[0] = force_.value;
  force.reach[0] = part * force_.rate;
  for (std::size_t k = 0; k < kBlock; ++k) {
    const double at = tau + static_cast<double>(k + 1) * longest_step_;
    out.force[k] = slow_.value_at(at) + sums[kBlockForce * kBlock + k];
    rate[k] = slow_.rate_at(at) + sums[kBlockRate * kBlock + k];
    force.value[k + 1] = out.force[k];
    force.reach[k + 1] = part * rate[k];
  }
  std::size_t steps = certified_steps(tau, force);
  if (steps < kBlock && !bound_is_fresh_) {
    refresh_bound();
    steps = certified_steps(tau, force);
  }
  if (steps == 0) return 0;
  fill_motions(tau, &sums[kBlockVelocity * kBlock], out);
  event::advance(block_factor_[steps - 1], loop_.pole, state_, state_);
  force_ = {out.force[steps - 1], rate[steps - 1]};
  bound_is_fresh_ = seen_is_valid_ = false;
  return steps;
}

// motion_at() for the ends of a block's steps side by side.
void Sticking::fill_motions(double tau, const double* seen, Block& out) const {
  const double* seen_left = seen + ClosedLoop::kLeft * kBlock;
  const double* seen_right = seen + ClosedLoop::kRight * kBlock;
  for (std::size_t k = 0; k < kBlock; ++k) {
    const double at = tau + static_cast<double>(k + 1) * longest_step_;
    out.velocity[k] = seen[k] + loop_.displacement.value * slow_.rate_at(at) +
                      loop_.displacement.rate * slow_.curvature;
    const double slip = out.velocity[k] - drive_.velocity_at(at);
    out.displacement[k] =
        rest_point_ + drive_.travel(at) - (out.force[k] + loop_.damping * slip) / loop_.stiffness;
    out.left[k] = seen_left[k] + loop_.left.at(slow_, at);
    out.right[k] = seen_right[k] + loop_.right.at(slow_, at);
  }
}

}  // namespace modcal::event
