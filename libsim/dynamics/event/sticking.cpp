#include "libsim/dynamics/event/sticking.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libsim/dynamics/event/first_crossing.hpp"

namespace modcal::event {
namespace {

using Complex = std::complex<double>;

// Largest |μ|h of a power series of 25 terms: 1.6²⁵/25! = 8e-21 of its size is left out.
constexpr double kSeriesPhase = 1.6;
// Force this close to the limit (relative) at the attachment is the limit: the continuous rule.
constexpr double kAtLimit = 1e-12;

PlanarVector exponentials(const PlanarVector& pole, std::size_t count, double time) {
  PlanarVector result(count);
  for (std::size_t j = 0; j < count; ++j) result.set(j, std::exp(pole.at(j) * time));
  return result;
}

}  // namespace

Sticking::Sticking(ClosedLoop loop, double bow_velocity, double static_limit, double longest_step,
                   MotionRequest wanted)
    : loop_(std::move(loop)),
      bow_velocity_(bow_velocity),
      limit_(static_limit),
      longest_step_(longest_step),
      series_step_(longest_step),
      series_(kTerms, loop_.roots),
      fourth_power_(padded_size(loop_.roots)),
      state_(loop_.roots),
      trial_(loop_.roots),
      wanted_(wanted) {
  while (series_step_ * loop_.largest_pole > kSeriesPhase) series_step_ *= 0.5;
  step_factor_ = exponentials(loop_.pole, loop_.roots, longest_step_);
  series_factor_ = exponentials(loop_.pole, loop_.roots, series_step_);
  for (std::size_t j = 0; j < loop_.roots; ++j) {
    const Complex x = loop_.pole.at(j) * series_step_;
    Complex term = 1.0;
    for (std::size_t p = 0; p < kTerms; ++p) {
      series_.set(p, j, term);
      term *= x / static_cast<double>(p + 1);
    }
    fourth_power_[j] = std::pow(std::abs(loop_.pole.at(j)), 4.0);
  }
  fill_block();
}

void Sticking::fill_block() {
  block_ = PlanarRows((kBlockVelocity + rows()) * kBlock, loop_.roots);
  for (std::size_t k = 0; k < kBlock; ++k) {
    block_factor_[k] =
        exponentials(loop_.pole, loop_.roots, static_cast<double>(k + 1) * longest_step_);
    for (std::size_t j = 0; j < loop_.roots; ++j) {
      const Complex factor = block_factor_[k].at(j);
      block_.set(kBlockForce * kBlock + k, j, factor);
      block_.set(kBlockRate * kBlock + k, j, loop_.pole.at(j) * factor);
      for (std::size_t r = 0; r < rows(); ++r) {
        const Complex weight{loop_.observed.re(r)[j], loop_.observed.im(r)[j]};
        block_.set((kBlockVelocity + r) * kBlock + k, j, weight * factor);
      }
    }
  }
}

void Sticking::attach(const PlanarVector& open_state, double displacement, double elongation) {
  rest_point_ = displacement - elongation;
  force_rate_ = loop_.force_rate(bow_velocity_);
  force_offset_ = loop_.force_offset(bow_velocity_, rest_point_);
  apply(loop_.to_closed, loop_.modes, open_state, state_);
  SumAndRate sums;
  for (std::size_t j = 0; j < loop_.roots; ++j) {
    state_.re[j] -= force_offset_ * loop_.constant.re[j] + force_rate_ * loop_.ramp.re[j];
    state_.im[j] -= force_offset_ * loop_.constant.im[j] + force_rate_ * loop_.ramp.im[j];
    sums.sum += state_.re[j];
    sums.rate += loop_.pole.re[j] * state_.re[j] - loop_.pole.im[j] * state_.im[j];
  }
  accept(0.0, sums);
  refresh_bound();
  starts_at_limit_ = 0;
  if (std::abs(force_.value) >= (1.0 - kAtLimit) * limit_) {
    starts_at_limit_ = force_.value > 0.0 ? 1 : -1;
  }
}

void Sticking::detach(double tau, PlanarVector& open_state) {
  apply(loop_.to_open, loop_.roots, state_, open_state);
  const double value = particular(tau);
  for (std::size_t n = 0; n < loop_.modes; ++n) {
    open_state.re[n] += value * loop_.open_constant.re[n] + force_rate_ * loop_.open_ramp.re[n];
    open_state.im[n] += value * loop_.open_constant.im[n] + force_rate_ * loop_.open_ramp.im[n];
  }
}

void Sticking::accept(double tau, const SumAndRate& sums) {
  force_ = {particular(tau) + sums.sum, force_rate_ + sums.rate};
}

std::size_t Sticking::rows() const {
  if (wanted_.reactions) return ClosedLoop::kRows;
  return wanted_.contact ? std::size_t{ClosedLoop::kLeft} : 0;
}

SumAndRate Sticking::propagate(double time, bool observed) {
  seen_is_valid_ = false;
  if (time == longest_step_) {
    seen_is_valid_ = observed;
    return event::advance(step_factor_, loop_.pole, state_, trial_, loop_.observed,
                          std::span(seen_).first(observed ? rows() : 0));
  }
  if (time == series_step_) return event::advance(series_factor_, loop_.pole, state_, trial_);
  return advance_by(time, loop_.pole, state_, trial_);
}

bool Sticking::hull_inside(double time, ForceJet start, ForceJet end) const {
  const double part = time * (1.0 / 3.0);
  const double second = start.value + part * start.rate;
  const double third = end.value - part * end.rate;
  const double largest = std::max(std::max(std::abs(start.value), std::abs(second)),
                                  std::max(std::abs(third), std::abs(end.value)));
  const double square = time * time;
  return largest + square * square * (fourth_derivative_ * (1.0 / 384.0)) < limit_;
}

void Sticking::refresh_bound() {
  fourth_derivative_ = weighted_size(fourth_power_, state_);
  bound_is_fresh_ = true;
}

bool Sticking::certified(double time, ForceJet end) {
  if (starts_at_limit_ != 0) return false;
  // |w_j| only falls while the string sticks, so that an older bound holds too.
  if (hull_inside(time, force_, end)) return true;
  if (bound_is_fresh_) return false;
  refresh_bound();
  return hull_inside(time, force_, end);
}

std::optional<double> Sticking::crossing(double tau, double time) {
  std::array<double, kTerms> force;
  real_products(series_, state_, force);
  const double ratio = time / series_step_;
  double scale = 1.0, swing = 0.0;
  for (double& c : force) {
    c *= scale;
    scale *= ratio;
  }
  force[0] += particular(tau);
  force[1] += force_rate_ * time;
  for (std::size_t p = 1; p < kTerms; ++p) swing += std::abs(force[p]);

  std::optional<double> first;
  for (const double sign : {1.0, -1.0}) {
    const bool starts_there = starts_at_limit_ == static_cast<int>(sign);
    if (!starts_there && sign * force[0] + swing < limit_) continue;
    std::array<double, kTerms> margin;
    for (std::size_t p = 0; p < kTerms; ++p) margin[p] = -sign * force[p];
    margin[0] += limit_;
    const auto found = first_crossing(margin, first.value_or(1.0), starts_there);
    if (found) first = found;
  }
  return first;
}

Sticking::Advance Sticking::advance(double tau, double time, bool observed) {
  SumAndRate sums = propagate(time, observed);
  bool safe = certified(time, {particular(tau + time) + sums.sum, force_rate_ + sums.rate});
  if (!safe && time > series_step_ * (1.0 + 1e-9)) {
    // A longer stretch than the series can tell is cut; the caller asks again for the rest.
    time = series_step_;
    sums = propagate(time, false);
    safe = certified(time, {particular(tau + time) + sums.sum, force_rate_ + sums.rate});
  }
  Advance result{time, false};
  if (!safe) {
    if (const auto theta = crossing(tau, time)) {
      result = {*theta * time, true};
      seen_is_valid_ = false;
      sums = advance_by(result.time, loop_.pole, state_, trial_);
    }
  }
  std::swap(state_, trial_);
  accept(tau + result.time, sums);
  bound_is_fresh_ = false;
  starts_at_limit_ = 0;
  return result;
}

std::size_t Sticking::certified_steps(const std::array<ForceJet, kBlock + 1>& force) const {
  std::size_t steps = 0;
  while (steps < kBlock && hull_inside(longest_step_, force[steps], force[steps + 1])) ++steps;
  return steps;
}

std::size_t Sticking::advance_block(double tau, Block& motions) {
  if (starts_at_limit_ != 0) return 0;
  std::array<double, kBlockRows * kBlock> sums{};
  real_products(block_, state_, std::span(sums).first(block_.count));
  std::array<ForceJet, kBlock + 1> force{force_};
  for (std::size_t k = 0; k < kBlock; ++k) {
    const double time = tau + static_cast<double>(k + 1) * longest_step_;
    force[k + 1] = {particular(time) + sums[kBlockForce * kBlock + k],
                    force_rate_ + sums[kBlockRate * kBlock + k]};
  }
  std::size_t steps = certified_steps(force);
  if (steps < kBlock && !bound_is_fresh_) {
    refresh_bound();
    steps = certified_steps(force);
  }
  if (steps == 0) return 0;
  for (std::size_t k = 0; k < steps; ++k) {
    const double* seen = &sums[kBlockVelocity * kBlock + k];
    motions[k] = motion_at(tau + static_cast<double>(k + 1) * longest_step_, force[k + 1].value,
                           {seen[0], seen[kBlock], seen[2 * kBlock]});
  }
  event::advance(block_factor_[steps - 1], loop_.pole, state_, state_);
  force_ = force[steps];
  bound_is_fresh_ = seen_is_valid_ = false;
  return steps;
}

Motion Sticking::motion_at(double tau, double force,
                           const std::array<double, ClosedLoop::kRows>& seen) const {
  const double value = particular(tau);
  Motion motion;
  motion.force = force;
  motion.velocity = seen[ClosedLoop::kVelocity] + loop_.displacement.value * force_rate_;
  motion.left = seen[ClosedLoop::kLeft] + loop_.left.value * value + loop_.left.rate * force_rate_;
  motion.right =
      seen[ClosedLoop::kRight] + loop_.right.value * value + loop_.right.rate * force_rate_;
  const double slip = motion.velocity - bow_velocity_;
  motion.displacement =
      rest_point_ + bow_velocity_ * tau - (force + loop_.damping * slip) / loop_.stiffness;
  return motion;
}

Motion Sticking::observe(double tau) {
  if (!seen_is_valid_) real_products(loop_.observed, state_, std::span(seen_).first(rows()));
  seen_is_valid_ = true;
  return motion_at(tau, force_.value, seen_);
}

}  // namespace modcal::event
