#include "libsim/dynamics/event/sticking.hpp"

#include "libsim/dynamics/event/modes/first_crossing.hpp"
#include "libsim/dynamics/event/tuning.hpp"

namespace modcal::event {
namespace {

using Complex = std::complex<double>;

}  // namespace

// With p = 1/(1 + e^x) and x = (ϑ − ϑ_s)/w the limit is μ_hot + (μ_cold − μ_hot) p, and
// p' = −p (1 − p) x', x' = −g (ϑ/w): the powers of p follow one after the other.
void StaticLimit::series(double tau, double time, std::span<double> out) const {
  // Fixed by: length of three arrays; no more than the terms of a series are asked for.
  constexpr std::size_t kMost = 32;
  assert(out.size() <= kMost);
  std::fill(out.begin(), out.end(), 0.0);
  if (!thermal_) {
    out[0] = force_;
    return;
  }
  const double decay = -cooling() * time;
  std::array<double, kMost> p{}, product{}, rate{};
  const double rise = rise_at(tau);
  rate[0] = decay * rise / thermal_->softening_width;
  for (std::size_t k = 1; k < out.size(); ++k) {
    rate[k] = rate[k - 1] * decay / static_cast<double>(k);
  }
  p[0] = thermal_->cold_share(rise);
  for (std::size_t k = 0; k + 1 < out.size(); ++k) {
    product[k] = p[k];
    for (std::size_t i = 0; i <= k; ++i) product[k] -= p[i] * p[k - i];
    double sum = 0.0;
    for (std::size_t i = 0; i <= k; ++i) sum += product[i] * rate[k - i];
    p[k + 1] = -sum / static_cast<double>(k + 1);
  }
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = thermal_->drop * p[k];
  out[0] += thermal_->hot;
}

Sticking::Sticking(ClosedLoop loop, StaticLimit static_limit, double longest_step,
                   MotionRequest wanted)
    : loop_(std::move(loop)),
      limit_(static_limit),
      longest_step_(longest_step),
      series_step_(longest_step),
      series_(kTerms, loop_.roots),
      fourth_power_(padded_size(loop_.roots)),
      state_(loop_.roots),
      trial_(loop_.roots),
      wanted_(wanted) {
  step_factor_.push_back(loop_.propagator(longest_step_));
  while (series_step_ * loop_.largest_pole > kStickingPhase) {
    series_step_ *= 0.5;
    step_factor_.push_back(loop_.propagator(series_step_));
  }
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

// Adds `factor` times the coordinates of the slow force at τ, those of Z or of w.
void Sticking::add_slow(double factor, double tau, const std::array<PlanarVector, 3>& columns,
                        PlanarVector& state) const {
  const std::array<double, 3> jet = {factor * slow_.value_at(tau), factor * slow_.rate_at(tau),
                                     factor * slow_.curvature};
  for (std::size_t k = 0; k < jet.size(); ++k) {
    for (std::size_t j = 0; j < state.size(); ++j) {
      state.re[j] += jet[k] * columns[k].re[j];
      state.im[j] += jet[k] * columns[k].im[j];
    }
  }
}

// Force and bounds at τ = 0 of the state at hand.
void Sticking::restart() {
  SumAndRate sums;
  for (std::size_t j = 0; j < loop_.roots; ++j) {
    sums.sum += state_.re[j];
    sums.rate += loop_.pole.re[j] * state_.re[j] - loop_.pole.im[j] * state_.im[j];
  }
  force_ = jet_at(0.0, sums);
  refresh_bound();
  seen_is_valid_ = false;
}

void Sticking::attach(const BowDrive& drive, const PlanarVector& open_state, double displacement,
                      double elongation, double rise) {
  limit_.start(rise);
  drive_ = drive;
  rest_point_ = displacement - elongation;
  slow_ = loop_.slow_force(drive.velocity, drive.acceleration, rest_point_);
  apply(loop_.to_closed, loop_.modes, open_state, state_);
  add_slow(-1.0, 0.0, loop_.closed_slow, state_);
  restart();
  const double at_limit = (1.0 - kAtLimit) * limit(0.0, 0.0).start;
  starts_at_upper_ = force_.value >= at_limit;
  starts_at_lower_ = -force_.value >= at_limit;
}

void Sticking::change_drive(double tau, const BowDrive& drive) {
  add_slow(1.0, tau, loop_.closed_slow, state_);
  rest_point_ += drive_.travel(tau);
  limit_.start(limit_.rise_at(tau));
  drive_ = drive;
  slow_ = loop_.slow_force(drive.velocity, drive.acceleration, rest_point_);
  add_slow(-1.0, 0.0, loop_.closed_slow, state_);
  restart();
}

void Sticking::detach(double tau, PlanarVector& open_state) {
  apply(loop_.to_open, loop_.roots, state_, open_state);
  add_slow(1.0, tau, loop_.open_slow, open_state);
}

std::size_t Sticking::rows() const {
  if (wanted_.reactions) return ClosedLoop::kRows;
  return wanted_.contact ? std::size_t{ClosedLoop::kLeft} : 0;
}

SumAndRate Sticking::propagate(double time, bool observed) {
  seen_is_valid_ = false;
  if (time == longest_step_) {
    seen_is_valid_ = observed;
    return modal_kernels().advance(step_factor_[0], loop_.pole, state_, trial_, loop_.observed,
                                   std::span(seen_).first(observed ? rows() : 0));
  }
  if (time == step_of(level_)) {
    return modal_kernels().advance(step_factor_[static_cast<std::size_t>(level_)], loop_.pole,
                                   state_, trial_, {}, {});
  }
  return modal_kernels().advance_by(time, loop_.pole, state_, trial_);
}

bool Sticking::hull_inside(double tau, double time, ForceJet start, ForceJet end) const {
  const double part = time * (1.0 / 3.0), square = time * time;
  const double excess =
      hull_excess(limit(tau, time), start.value, part * start.rate, end.value, part * end.rate);
  return excess + square * square * (fourth_derivative_ * (1.0 / 384.0)) < 0.0 &&
         std::isfinite(end.value);
}

void Sticking::refresh_bound() {
  fourth_derivative_ = modal_kernels().weighted_size(fourth_power_, state_);
  bound_is_fresh_ = true;
}

bool Sticking::certified(double tau, double time, ForceJet end) {
  if (starts_at_upper_ || starts_at_lower_) return false;
  // |w_j| only falls while the string sticks, so that an older bound holds too.
  if (hull_inside(tau, time, force_, end)) return true;
  if (bound_is_fresh_) return false;
  refresh_bound();
  return hull_inside(tau, time, force_, end);
}

// Powers of θ of the limit at τ + θ·time.
std::array<double, Sticking::kTerms> Sticking::limit_series(double tau, double time) const {
  std::array<double, kTerms> bound;
  limit_.series(tau, time, bound);
  const double load = drive_.load_at(tau), change = drive_.load_at(tau + time) - load;
  for (std::size_t p = kTerms; p-- > 1;) bound[p] = load * bound[p] + change * bound[p - 1];
  bound[0] *= load;
  return bound;
}

std::array<double, Sticking::kTerms> Sticking::force_series(const PlanarVector& state, double tau,
                                                            double time) const {
  std::array<double, kTerms> force;
  modal_kernels().real_products(series_, state, force);
  const double ratio = time / series_step_;
  double scale = 1.0;
  for (double& c : force) {
    c *= scale;
    scale *= ratio;
  }
  force[0] += slow_.value_at(tau);
  force[1] += slow_.rate_at(tau) * time;
  force[2] += 0.5 * slow_.curvature * time * time;
  return force;
}

std::optional<Sticking::Advance> Sticking::crossing(double tau, double time) {
  const std::array<double, kTerms> force = force_series(state_, tau, time);
  double swing = 0.0;
  for (std::size_t p = 1; p < kTerms; ++p) swing += std::abs(force[p]);

  const Limit at = limit(tau, time);
  const std::array<double, kTerms> bound = limit_series(tau, time);
  std::optional<double> first;
  Advance result;
  for (const int sign : {1, -1}) {
    const bool starts_there = sign > 0 ? starts_at_upper_ : starts_at_lower_;
    if (!starts_there && sign * force[0] + swing < std::min(at.start, at.end)) continue;
    std::array<double, kTerms> margin;
    for (std::size_t p = 0; p < kTerms; ++p) margin[p] = bound[p] - sign * force[p];
    const auto found = first_crossing(margin, first.value_or(1.0), starts_there);
    if (!found) continue;
    first = found;
    result = {*found * time, sign};
  }
  if (!first) return std::nullopt;
  return result;
}

Sticking::Advance Sticking::advance(double tau, double time, bool observed) {
  const int last_level = static_cast<int>(step_factor_.size()) - 1;
  const auto cut = [&](double longest) {
    if (time > longest * (1.0 + 1e-9)) time = longest;
  };
  cut(step_of(level_));
  SumAndRate sums = propagate(time, observed);
  bool safe = certified(tau, time, jet_at(tau + time, sums));
  // A stretch that is not certified is cut down to what the series can tell; the caller asks again
  // for the rest.
  while (!safe && time > reach() * (1.0 + 1e-9)) {
    if (level_ == last_level) {
      cut(reach());
    } else {
      cut(step_of(++level_));
    }
    certified_in_a_row_ = 0;
    sums = propagate(time, false);
    safe = certified(tau, time, jet_at(tau + time, sums));
  }
  if (safe && level_ > 0 && ++certified_in_a_row_ > 4) {
    --level_;
    certified_in_a_row_ = 0;
  }
  Advance result{time, 0};
  if (!safe) {
    if (const auto release = crossing(tau, time)) {
      result = *release;
      seen_is_valid_ = false;
      sums = modal_kernels().advance_by(result.time, loop_.pole, state_, trial_);
    }
  }
  std::swap(state_, trial_);
  force_ = jet_at(tau + result.time, sums);
  bound_is_fresh_ = false;
  starts_at_upper_ = starts_at_lower_ = false;
  return result;
}

MotionSample Sticking::observe(double tau) {
  if (!seen_is_valid_)
    modal_kernels().real_products(loop_.observed, state_, std::span(seen_).first(rows()));
  seen_is_valid_ = true;
  return motion_at(tau, force_.value, seen_);
}

}  // namespace modcal::event
