// The string held by the bow: advanced exactly, with a certificate that it was not let go in
// between.
#pragma once

#include <cassert>

#include "libsim/dynamics/event/modes/bow_path.hpp"
#include "libsim/dynamics/event/modes/closed_loop.hpp"

namespace modcal::event {

/// Static limit at load 1 [N] as a function of the time τ [s] of adherence: a constant, or
/// μ(ϑ₀ e^{−Gτ/H}) of a contact with a temperature. It never falls with τ.
class StaticLimit {
 public:
  explicit StaticLimit(double force) : force_(force) {}
  explicit StaticLimit(const ThermalSliding& law) : force_(law.at(0.0).force), thermal_(law) {}

  /// τ = 0 with the temperature rise ϑ₀ ≥ 0 [K].
  void start(double rise) {
    if (thermal_) thermal_->rise = rise;
  }
  double rise_at(double tau) const {
    return thermal_ ? thermal_->rise * std::exp(-cooling() * tau) : 0.0;
  }
  double at(double tau) const {
    return thermal_ ? thermal_->softening_at(rise_at(tau)).coefficient : force_;
  }
  /// Time [s] within which the power series about any τ ≥ 0 converges as 0.16^p at least: its next
  /// singularity is where ϑ has moved by πw in the complex plane.
  double reach() const {
    if (!thermal_ || cooling() == 0.0) return HUGE_VAL;
    return 0.5 / (cooling() * (1.0 + thermal_->rise / thermal_->softening_width));
  }
  /// Coefficients of the powers of θ of the limit at τ + θ·time.
  void series(double tau, double time, std::span<double> out) const;

 private:
  double cooling() const { return thermal_->conductance / thermal_->capacity; }

  double force_;
  std::optional<ThermalSliding> thermal_;
};

/// One stretch of adherence to a bow whose velocity and load are linear in time. τ [s] runs from
/// the attachment or from the last change of the drive.
class Sticking {
 public:
  /// `longest_step` [s]: no call of advance() asks for more.
  /// `static_limit` [N] at load 1.
  Sticking(ClosedLoop loop, StaticLimit static_limit, double longest_step, MotionRequest wanted);

  /// Starts from the open-loop state Z with the contact at y [m] and its spring stretched by
  /// `elongation` [m] and its temperature risen by `rise` [K], where it has one.
  void attach(const BowDrive& drive, const PlanarVector& open_state, double displacement,
              double elongation, double rise = 0.0);
  /// The bow moves on differently from τ, which becomes τ = 0.
  void change_drive(double tau, const BowDrive& drive);
  /// Open-loop state Z at τ.
  void detach(double tau, PlanarVector& open_state);

  struct Advance {
    double time = 0.0;  ///< how far it went [s], at most the time asked for
    int released = 0;   ///< the sign of the limit that f reached there; 0: none
  };
  /// Advances from τ by at most `time`. Either no event happens on the stretch (Bézier hull of the
  /// cubic Hermite interpolant of f plus its remainder h⁴/384 Σ|μ_j|⁴|w_j| inside the limits), or
  /// the first crossing of the power series of f is located to rounding; where the series does not
  /// converge fast, a shorter stretch is taken.
  /// `observed`: observe() is called there, if no event comes first.
  Advance advance(double tau, double time, bool observed);

  /// Samples in a row, each a longest step after the one before.
  /// Fixed by: length of the rows of a block, whose steps are taken or left one by one.
  static constexpr std::size_t kBlock = 4;
  struct Block {
    using Row = std::array<double, kBlock>;
    Row displacement, velocity, force, left, right;

    /// Writes the first `count` of them, from `sample` on.
    void write(const SampleTargets& to, std::size_t sample, std::size_t count) const {
      const auto copy = [&](const Row& row, double* target) {
        if (target == nullptr) return;
        if (count == kBlock) {  // known to the compiler: no call
          std::copy_n(row.begin(), kBlock, target + sample);
        } else {
          std::copy_n(row.begin(), count, target + sample);
        }
      };
      copy(displacement, to.displacement);
      copy(velocity, to.velocity);
      copy(force, to.force);
      copy(left, to.left_reaction);
      copy(right, to.right_reaction);
    }
  };
  /// Advances from τ by as many longest steps, at most kBlock, as are certified free of events, and
  /// tells what happens at their ends. Possibly none: advance() decides then.
  std::size_t advance_block(double tau, Block& out);

  const PlanarVector& state() const { return state_; }
  /// Shows the force from τ on for `time` [s] piece by piece; `before`: the state at τ.
  void show(const PlanarVector& before, double tau, double time, ForceObserver& observer);

  double force() const { return force_.value; }
  /// Temperature rise at τ [K].
  double rise(double tau) const { return limit_.rise_at(tau); }
  /// y_c at τ, the contact being at y [m].
  double elongation(double tau, double displacement) const {
    return displacement - rest_point_ - drive_.travel(tau);
  }
  MotionSample observe(double tau);

 private:
  // Fixed by: rounding; |μ|h ≤ kStickingPhase leaves 1.6²⁵/25! = 8e-21.
  static constexpr std::size_t kTerms = 25;
  struct ForceJet {
    double value = 0.0;
    double rate = 0.0;
  };
  struct Limit {
    double start = 0.0, end = 0.0;
  };
  // A line below the limit: the contact only cools.
  Limit limit(double tau, double time) const {
    const double at_start = limit_.at(tau);
    return {at_start * drive_.load_at(tau), at_start * drive_.load_at(tau + time)};
  }
  // How far the Bézier polygon of the cubic with these forces at its ends goes beyond a limit that
  // is a line: its own control points lie on it. `reach`: a third of the step's change by the rate.
  static double hull_excess(const Limit& at, double start, double start_reach, double end,
                            double end_reach) {
    const double fall = (at.end - at.start) * (1.0 / 3.0);
    return std::max(
        std::max(std::abs(start) - at.start, std::abs(start + start_reach) - (at.start + fall)),
        std::max(std::abs(end - end_reach) - (at.end - fall), std::abs(end) - at.end));
  }
  double reach() const { return std::min(series_step_, limit_.reach()); }
  std::array<double, kTerms> limit_series(double tau, double time) const;
  std::array<double, kTerms> force_series(const PlanarVector& state, double tau, double time) const;
  ForceJet jet_at(double tau, const SumAndRate& sums) const {
    return {slow_.value_at(tau) + sums.sum, slow_.rate_at(tau) + sums.rate};
  }
  double series_time(const PlanarVector& state, double tau, double time);
  void add_slow(double factor, double tau, const std::array<PlanarVector, 3>& columns,
                PlanarVector& state) const;
  void restart();
  std::size_t rows() const;
  SumAndRate propagate(double time, bool observed);
  bool certified(double tau, double time, ForceJet end);
  bool hull_inside(double tau, double time, ForceJet start, ForceJet end) const;
  void refresh_bound();
  std::optional<Advance> crossing(double tau, double time);
  void fill_block();
  // Force and a third of a step's change by its rate at the start and at the ends of a block.
  struct BlockForce {
    std::array<double, kBlock + 1> value, reach;
  };
  std::size_t certified_steps(double tau, const BlockForce& force) const;
  double step_of(int level) const { return std::ldexp(longest_step_, -level); }
  // `seen`: the rows' values of the homogeneous motion.
  MotionSample motion_at(double tau, double force,
                         const std::array<double, ClosedLoop::kRows>& seen) const {
    MotionSample motion;
    motion.force = force;
    motion.velocity = seen[ClosedLoop::kVelocity] + loop_.displacement.value * slow_.rate_at(tau) +
                      loop_.displacement.rate * slow_.curvature;
    motion.left = seen[ClosedLoop::kLeft] + loop_.left.at(slow_, tau);
    motion.right = seen[ClosedLoop::kRight] + loop_.right.at(slow_, tau);
    const double slip = motion.velocity - drive_.velocity_at(tau);
    motion.displacement =
        rest_point_ + drive_.travel(tau) - (force + loop_.damping * slip) / loop_.stiffness;
    return motion;
  }

  ClosedLoop loop_;
  StaticLimit limit_;
  double longest_step_, series_step_;
  // Steps that were not certified are halved down to the series' own and grow again with success.
  std::vector<PlanarVector> step_factor_;  // e^{μh}, h = longest_step/2^j
  int level_ = 0, certified_in_a_row_ = 0;
  PlanarRows series_;           // (μ·series_step)^p/p!
  AlignedVector fourth_power_;  // |μ|⁴
  AlignedVector last_power_;    // (|μ|·series_step)²⁵/25!, for show()
  // Rows of f, f', v, R₁, R₂ (as many as wanted) for the ends of the kBlock steps.
  enum BlockRow : std::size_t {
    kBlockForce,
    kBlockRate,
    kBlockVelocity,
    kBlockRows = kBlockVelocity + std::size_t{ClosedLoop::kRows}
  };
  PlanarRows block_;
  std::array<PlanarVector, kBlock> block_factor_;
  PlanarVector state_, trial_;
  MotionRequest wanted_;
  std::array<double, ClosedLoop::kRows> seen_{};  // the rows' values for the state, if known
  bool seen_is_valid_ = false;
  BowDrive drive_;
  double rest_point_ = 0.0;
  SlowForce slow_;
  ForceJet force_;
  double fourth_derivative_ = 0.0;
  bool bound_is_fresh_ = false;
  // Just attached with the force at its upper, its lower limit: that root is no release.
  bool starts_at_upper_ = false, starts_at_lower_ = false;
};

/// The string held by a contact. Throws InvalidInput where its closed loop has a double root, or
/// one that turns by more than 1e4 rad in a step.
Sticking held_string(const ContactModes& modes, const ContactParameters& contact,
                     const StaticLimit& static_limit, double longest_step, MotionRequest wanted);

}  // namespace modcal::event
