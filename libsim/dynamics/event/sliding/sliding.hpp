// The sliding string: collocation steps, and the instant at which the bow catches it.
#pragma once

#include "libsim/dynamics/event/modes/bow_path.hpp"
#include "libsim/dynamics/event/modes/first_crossing.hpp"
#include "libsim/dynamics/event/sliding/contact_friction.hpp"
#include "libsim/dynamics/event/sliding/tuning.hpp"

namespace modcal::event {

/// One stretch of sliding with sign side = sgn(v_c), f = −side·load·g(side·v_c). Position x in
/// [0, 1] counts grid steps; steps are dyadic parts of one, one of any length leads to the next
/// dyadic point or to where the bow's drive changes.
template <typename Friction>
class Sliding {
 public:
  /// `slope_number` κ: the steps h keep |g'(u)| h/m_eff ≤ κ at their start and ≤ 2κ at every node,
  /// where the friction equation has one solution. `tail_ratio` r: with f = Σ F_k θ^k through the
  /// s nodes they keep |F_{s−1}| h/m_eff ≤ r^{s−1} (|v_bow| + max u_i).
  Sliding(SlidingModel& model, const Friction& friction, double slope_number, double tail_ratio)
      : model_(model),
        law_(friction),
        slope_number_(slope_number),
        longest_tail_(model.effective_mass() * std::pow(tail_ratio, model.rule().nodes - 1)) {}

  /// Starts with the sliding speed u = side·v_c ≥ 0 under the given load.
  void start(double side, double speed, double load) {
    side_ = side;
    speed_ = std::max(speed, 0.0);
    const NodeFriction first = law_.at(speed_, load);
    friction_ = first.friction;
    slope_ = first.slope;
    refinement_ = 0;
    powers_ = {friction_};
    last_length_ = 0.0;
    attached_part_ = 1.0;
  }

  enum class Outcome {
    kAdvanced,
    kRefined,   ///< nothing moved; the next step is shorter
    kAttached,  ///< v_c = 0 there
    kFailed,    ///< no step is short enough
  };
  struct Advance {
    double position;
    Outcome outcome;
  };
  /// Advances `state` from x by one step at most, not beyond `last`; `drive` has its τ = 0 at x.
  Advance advance(double x, double last, const BowDrive& drive, PlanarVector& state) {
    drive_ = drive;
    int level = wanted_level() + refinement_;
    if (level > kDeepestLevel) return {x, Outcome::kFailed};
    const double parts = std::ldexp(1.0, level);
    double end = (std::floor(x * parts) + 1.0) / parts;
    if ((end - x) * parts < 1e-9) end += 1.0 / parts;  // x is that point but for rounding
    end = std::min(end, last);
    // Behind a refined step: a half, a quarter, … of a step has its table too.
    int deeper = 0;
    const bool on_grid = std::frexp((end - x) * parts, &deeper) == 0.5;
    level += 1 - deeper;
    NodeValues values = start_values((end - x) * model_.grid_step());
    const bool from_tables = on_grid && speed_ > 0.0;
    if (from_tables) {
      const auto result = grid_step(model_.table(level), end, state, values);
      if (result) return *result;
    }
    return any_step(x, end, state, values, from_tables);
  }

  /// Shows the force of the last step that moved, at whose start the bow's drive was `drive`.
  void show(const BowDrive& drive, ForceObserver& observer) const {
    NodeVector force = powers_;
    double scale = -side_;
    for (double& c : force) {
      c *= scale;
      scale *= attached_part_;
    }
    observer.piece({.phase = ContactPhase::kSliding,
                    .duration = attached_part_ * last_length_ * model_.grid_step(),
                    .force = std::span(force).first(static_cast<std::size_t>(nodes())),
                    .drive = drive,
                    .side = side_,
                    .rise = law_.rise_powers()});
  }

  double side() const { return side_; }
  double force() const { return -side_ * friction_; }
  /// Steps that were taken back for shorter ones.
  std::size_t refined_steps() const { return refined_; }
  Friction& friction() { return law_; }

 private:
  int wanted_level() const {
    int level = model_.first_level();
    double number = -slope_ * std::ldexp(model_.grid_step(), -level) / model_.effective_mass();
    for (; number > slope_number_ && level <= kDeepestLevel; number *= 0.5) ++level;
    return level;
  }

  // Node 1 and the loads of a step of the given length [s].
  NodeValues start_values(double step) const {
    NodeValues values;
    values.speed[0] = speed_;
    values.friction[0] = friction_;
    values.slope[0] = slope_;
    set_loads(step, values);
    return values;
  }
  void set_loads(double step, NodeValues& values) const {
    for (int i = 0; i < nodes(); ++i) {
      values.load[i] = drive_.load_at(step * model_.rule().node[i]);
    }
  }
  // Sliding speed of a string with velocity v at a node.
  double sliding_speed(double velocity, double step, int node) const {
    return side_ * (velocity - drive_.velocity_at(step * model_.rule().node[node]));
  }

  bool steep(const NodeValues& values, double step) const {
    double steepest = 0.0;
    for (int i = 0; i < nodes(); ++i) steepest = std::max(steepest, -values.slope[i]);
    return steepest * step > 2.0 * slope_number_ * model_.effective_mass();
  }

  // The powers of the force do not fall fast enough for the polynomial to stand for it. Below 1e-12
  // of the force they are the rounding of its values at the nodes, whatever the speed.
  bool unresolved(const NodeValues& values, const NodeVector& powers, double step) const {
    double speed = 0.0;
    for (int i = 0; i < nodes(); ++i) speed = std::max(speed, values.speed[i]);
    const double tail = std::abs(powers[static_cast<std::size_t>(nodes() - 1)]);
    return tail * step > longest_tail_ * (speed + std::abs(drive_.velocity)) &&
           tail > 1e-12 * friction_;
  }

  // `length`: of the step, in grid steps.
  void accept(const NodeValues& values, const NodeVector& powers, double length) {
    law_.accept(1.0);
    const int last = nodes() - 1;
    speed_ = values.speed[last];
    friction_ = values.friction[last];
    slope_ = values.slope[last];
    powers_ = powers;
    last_length_ = length;
    attached_part_ = 1.0;
    refinement_ = 0;
  }

  // Scale of a guess from the polynomial of the last step. None so far to go by, or one so short
  // that its polynomial is rounding this far out: a constant.
  double extrapolation(double length) const {
    return length <= kFarthestGuess * last_length_ ? length / last_length_ : 0.0;
  }

  Advance refined(double x) {
    ++refinement_;
    ++refined_;
    return {x, Outcome::kRefined};
  }

  // A dyadic step from the tables. Nothing where it may hold a switch: the series decide then, for
  // which `values` holds the solution.
  std::optional<Advance> grid_step(const SlidingTable& table, double end, PlanarVector& state,
                                   NodeValues& values) {
    NodeVector free{};
    const auto unknowns = static_cast<std::size_t>(nodes() - 1);
    modal_kernels().real_products(table.rows, state, std::span(free).subspan(1, unknowns));
    for (int i = 1; i < nodes(); ++i) free[i] = sliding_speed(free[i], table.step, i);
    const double length = table.step / model_.grid_step();
    guess_speeds(model_.rule(), table.coupling, free, {powers_, 1.0, extrapolation(length)},
                 values);
    if (!law_.solve(table.coupling, free, table.step, values) || steep(values, table.step)) {
      return refined(end - length);
    }
    const NodeVector powers = model_.rule().powers_of(values.friction);
    if (unresolved(values, powers, table.step)) return refined(end - length);
    if (!stays_sliding(table, values, powers, state)) return std::nullopt;
    NodeVector force{};
    for (int j = 0; j < nodes(); ++j) force[j] = -side_ * values.friction[j];
    modal_kernels().advance_driven(table.factor, table.response,
                                   std::span(force).first(unknowns + 1), state);
    accept(values, powers, length);
    return Advance{end, Outcome::kAdvanced};
  }

  // Bézier hull of the interpolated speed beyond its interpolation error: u > 0 throughout.
  bool stays_sliding(const SlidingTable& table, const NodeValues& values, const NodeVector& powers,
                     const PlanarVector& state) const {
    const double lowest = model_.rule().lowest_control(values.speed);
    if (!(lowest > 0.0)) return false;
    double remainder = table.free_remainder * model_.free_derivative_bound(state);
    for (int k = 0; k < nodes(); ++k) remainder += table.forced_remainder[k] * std::abs(powers[k]);
    return lowest > remainder;
  }

  // A step of any length. A switch is found by repeating the whole step with the length at which
  // the last one crossed v_c = 0: the step that is kept ends there and nothing is interpolated.
  // `values`: the solution of the first trial where it is `solved`.
  Advance any_step(double x, double end, PlanarVector& state, NodeValues values, bool solved) {
    Series free;
    model_.free_series(state, free);
    double length = end - x;
    const double series_length = model_.series_step() / model_.grid_step();
    NodeVector powers = powers_;
    double from = 1.0, scale = extrapolation(length);
    for (int trial = 0; trial < kSwitchTrials; ++trial) {
      if (trial > 0 && length < 1e-15) {
        last_length_ = 0.0;
        return {x, Outcome::kAttached};
      }
      const double ratio = length / series_length, step = length * model_.grid_step();
      set_loads(step, values);
      if (!solved &&
          (!solve_any(free, ratio, from, scale, powers, values) || steep(values, step))) {
        return refined(x);
      }
      solved = false;
      powers = model_.rule().powers_of(values.friction);
      if (unresolved(values, powers, step)) return refined(x);
      NodeVector force;
      for (std::size_t k = 0; k < force.size(); ++k) force[k] = -side_ * powers[k];
      const auto theta =
          first_crossing(speed_series(free, ratio, force), trial == 0 ? 1.0 : 1.1, speed_ == 0.0);
      if (!theta) {
        model_.advance_any(ratio, 1.0, force, state);
        accept(values, powers, length);
        return {trial == 0 ? end : x + length, Outcome::kAdvanced};
      }
      if (std::abs(*theta - 1.0) <= kLastCorrection) {
        model_.advance_any(ratio, *theta, force, state);
        law_.accept(*theta);
        powers_ = powers;
        last_length_ = length;
        attached_part_ = *theta;
        return {x + *theta * length, Outcome::kAttached};
      }
      length *= *theta;
      from = 0.0;
      scale = *theta;
    }
    return refined(x);
  }

  bool solve_any(const Series& free_velocity, double ratio, double from, double scale,
                 const NodeVector& powers, NodeValues& values) {
    NodeVector free{}, velocity{};
    for (std::size_t p = kSeriesTerms; p-- > 0;) {
      for (int i = 1; i < nodes(); ++i) {
        velocity[i] = velocity[i] * (ratio * model_.rule().node[i]) + free_velocity[p];
      }
    }
    const double step = ratio * model_.series_step();
    for (int i = 1; i < nodes(); ++i) free[i] = sliding_speed(velocity[i], step, i);
    const NodeMatrix coupling = model_.coupling(ratio);
    guess_speeds(model_.rule(), coupling, free, {powers, from, scale}, values);
    return law_.solve(coupling, free, step, values);
  }

  // u(θ) of a step, θ = 1 at its end.
  Series speed_series(const Series& free_velocity, double ratio, const NodeVector& force) const {
    Series speed{};
    double scale = 1.0;
    for (std::size_t p = 0; p < kSeriesTerms; ++p) {
      speed[p] = free_velocity[p] * scale;
      scale *= ratio;
    }
    model_.add_forced_series(ratio, force, speed);
    speed[1] -= drive_.acceleration * ratio * model_.series_step();
    for (double& c : speed) c *= side_;
    speed[0] = speed_;
    return speed;
  }

  int nodes() const { return model_.rule().nodes; }

  SlidingModel& model_;
  Friction law_;
  double slope_number_;
  double longest_tail_;  // m_eff r^{s−1}
  BowDrive drive_;       // from the start of the running step
  double side_ = -1.0, speed_ = 0.0, friction_ = 0.0, slope_ = 0.0;
  // Power coefficients of the friction on the last step, and its length in grid steps; none: 0.
  NodeVector powers_{};
  double last_length_ = 0.0;
  double attached_part_ = 1.0;  // of that step, where the string stuck inside it
  int refinement_ = 0;
  std::size_t refined_ = 0;
};

}  // namespace modcal::event
