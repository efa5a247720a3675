// The held string beside its single steps: how it is made and shown, some steps at once.

#include "libsim/dynamics/event/sticking.hpp"
#include "libsim/dynamics/event/tuning.hpp"

namespace modcal::event {

Sticking held_string(const ContactModes& modes, const ContactParameters& contact,
                     const StaticLimit& static_limit, double longest_step, MotionRequest wanted) {
  auto closed = make_closed_loop(modes, contact.stiffness, contact.damping);
  MODCAL_REQUIRE(closed.has_value(),
                 "adherence of {:g} N/m and {:g} N s/m gives the held string a double root, which "
                 "its exact propagator cannot resolve; change the damping slightly",
                 contact.stiffness, contact.damping);
  MODCAL_REQUIRE(closed->largest_pole * longest_step <= kMostStickingPhase,
                 "adherence of {:g} N/m and {:g} N s/m has a pole of {:g} 1/s: more than {:g} "
                 "radians in a step of {:g} s; shorten the step or soften the contact",
                 contact.stiffness, contact.damping, closed->largest_pole, kMostStickingPhase,
                 longest_step);
  return {std::move(*closed), static_limit, longest_step, wanted};
}

// How much of `time` from the state at τ on the series of the force tells to rounding:
// Σ |w_j| (|μ_j| t)²⁵/25! ≤ kLeftOutOfSeries of the limit.
double Sticking::series_time(const PlanarVector& state, double tau, double time) {
  if (last_power_.empty()) {
    last_power_.resize(fourth_power_.size());
    for (std::size_t j = 0; j < loop_.roots; ++j) {
      last_power_[j] = std::pow(std::abs(loop_.pole.at(j)) * series_step_, double{kTerms}) /
                       std::tgamma(kTerms + 1.0);
    }
  }
  const double left_out = modal_kernels().weighted_size(last_power_, state);
  const double allowed = kLeftOutOfSeries * limit_.at(tau) * drive_.load_at(tau);
  const double reach = std::pow(allowed / left_out, 1.0 / double{kTerms});
  return std::min(time, series_step_ * std::max(1.0, reach));
}

void Sticking::show(const PlanarVector& before, double tau, double time, ForceObserver& observer) {
  const double least = 1e-15 * time;
  for (double from = 0.0; time - from > least;) {
    modal_kernels().advance_by(from, loop_.pole, before, trial_);
    const double length = series_time(trial_, tau + from, time - from);
    const auto force = force_series(trial_, tau + from, length);
    observer.piece({.phase = ContactPhase::kSticking,
                    .duration = length,
                    .force = force,
                    .drive = drive_.from(tau + from)});
    from += length;
  }
}

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
    excess[k] = hull_excess({start[k], end[k]}, force.value[k], force.reach[k], force.value[k + 1],
                            force.reach[k + 1]);
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
  modal_kernels().real_products(block_, state_, std::span(sums).first(block_.count));
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
  const double* seen = &sums[kBlockVelocity * kBlock];
  for (std::size_t k = 0; k < kBlock; ++k) {
    const MotionSample motion = motion_at(
        tau + static_cast<double>(k + 1) * longest_step_, out.force[k],
        {seen[k], seen[ClosedLoop::kLeft * kBlock + k], seen[ClosedLoop::kRight * kBlock + k]});
    out.velocity[k] = motion.velocity;
    out.displacement[k] = motion.displacement;
    out.left[k] = motion.left;
    out.right[k] = motion.right;
  }
  modal_kernels().advance(block_factor_[steps - 1], loop_.pole, state_, state_, {}, {});
  force_ = {out.force[steps - 1], rate[steps - 1]};
  bound_is_fresh_ = seen_is_valid_ = false;
  return steps;
}

}  // namespace modcal::event
