// The string held by the bow: advanced exactly, with a certificate that it was not let go in
// between.
#pragma once

#include <array>
#include <optional>

#include "libsim/dynamics/event/closed_loop.hpp"
#include "libsim/dynamics/event/motion.hpp"

namespace modcal::event {

/// One stretch of adherence. Time τ [s] runs from the attachment.
class Sticking {
 public:
  /// `longest_step` [s]: no call of advance() asks for more.
  Sticking(ClosedLoop loop, double bow_velocity, double static_limit, double longest_step,
           MotionRequest wanted);

  /// Starts from the open-loop state Z with the contact at y [m] and its spring stretched by
  /// `elongation` [m].
  void attach(const PlanarVector& open_state, double displacement, double elongation);
  /// Open-loop state Z at τ.
  void detach(double tau, PlanarVector& open_state);

  struct Advance {
    double time = 0.0;      ///< how far it went [s], at most the time asked for
    bool released = false;  ///< |f| reached the limit there
  };
  /// Advances from τ by at most `time`. Either no event happens on the stretch (Bézier hull of the
  /// cubic Hermite interpolant of f plus its remainder h⁴/384 Σ|μ_j|⁴|w_j| inside the limits), or
  /// the first crossing of the power series of f is located to rounding; where the series does not
  /// converge fast, a shorter stretch is taken.
  /// `observed`: observe() is called there, if no event comes first.
  Advance advance(double tau, double time, bool observed);

  /// Samples in a row, each a longest step after the one before.
  static constexpr std::size_t kBlock = 4;
  using Block = std::array<Motion, kBlock>;
  /// Advances from τ by as many longest steps, at most kBlock, as are certified free of events, and
  /// tells what happens at their ends. Possibly none: advance() decides then.
  std::size_t advance_block(double tau, Block& motions);

  double force() const { return force_.value; }
  double rest_point() const { return rest_point_; }
  Motion observe(double tau);

 private:
  static constexpr std::size_t kTerms = 25;

  double particular(double tau) const { return force_offset_ + force_rate_ * tau; }
  std::size_t rows() const;
  SumAndRate propagate(double time, bool observed);
  struct ForceJet {
    double value = 0.0;
    double rate = 0.0;
  };
  bool certified(double time, ForceJet end);
  bool hull_inside(double time, ForceJet start, ForceJet end) const;
  void refresh_bound();
  std::optional<double> crossing(double tau, double time);
  void fill_block();
  std::size_t certified_steps(const std::array<ForceJet, kBlock + 1>& force) const;
  Motion motion_at(double tau, double force,
                   const std::array<double, ClosedLoop::kRows>& seen) const;
  void accept(double tau, const SumAndRate& sums);

  ClosedLoop loop_;
  double bow_velocity_, limit_, longest_step_, series_step_;
  std::size_t halvings_ = 0;  // series_step_ = longest_step_/2^halvings_
  PlanarVector step_factor_, series_factor_;
  PlanarRows series_;           // (μ·series_step)^p/p!
  AlignedVector fourth_power_;  // |μ|⁴
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
  double rest_point_ = 0.0, force_offset_ = 0.0, force_rate_ = 0.0;
  ForceJet force_;
  double fourth_derivative_ = 0.0;
  bool bound_is_fresh_ = false;
  // Just attached with the force at one of its limits (+1, −1): that root is no release.
  int starts_at_limit_ = 0;
};

}  // namespace modcal::event
