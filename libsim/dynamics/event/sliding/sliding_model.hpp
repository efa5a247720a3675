// What collocation of the sliding string needs from its modes: tables for the steps of the grid,
// power series for steps of any length.
#pragma once

#include "libsim/dynamics/event/modes/modal_kernels.hpp"
#include "libsim/dynamics/event/sliding/lobatto.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal::event {

using NodeVector = LobattoRule::Row;
using NodeMatrix = std::array<NodeVector, kMaxNodes>;

/// Terms of the power series in time.
/// Fixed by: rounding; |λ|h ≤ kSlidingPhase leaves 1.3²²/22! = 3e-19.
inline constexpr std::size_t kSeriesTerms = 22;
using Series = std::array<double, kSeriesTerms>;

/// One length of step h. With the force f(θh) = Σ_j F_j ℓ_j(θ) at the nodes θ = c_i:
/// v_i = Re rows_i·Z + Σ_j coupling[i][j] F_j and Z(h) = E Z + Σ_j response_j F_j.
struct SlidingTable {
  double step = 0.0;      ///< h [s]
  PlanarRows rows;        ///< nodes 2…s
  NodeMatrix coupling{};  ///< [m/(N s)]
  PlanarVector factor;    ///< E = e^{λh}
  PlanarRows response;
  double free_remainder = 0.0;    ///< times Σ|a λ^s||Z|: interpolation error of the free velocity
  NodeVector forced_remainder{};  ///< times |k-th power coefficient of f|: that of the forced part
};

class SlidingModel {
 public:
  /// `grid_step` [s]: step of level 0; level j is grid_step/2^j.
  SlidingModel(const ContactModes& modes, const LobattoRule& rule, double grid_step);

  const LobattoRule& rule() const { return rule_; }
  double effective_mass() const { return effective_mass_; }
  double grid_step() const { return grid_step_; }
  /// First level whose step is short enough for the series, |λ|h ≤ 1.3.
  int first_level() const { return first_level_; }
  double series_step() const { return series_step_; }
  const SlidingTable& table(int level);

  /// v(t) = Σ_p out[p] (t/series_step)^p without force.
  void free_series(const PlanarVector& state, Series& out) const;
  /// Coupling of a step of any length `ratio`·series_step, ratio ≤ 1 + rounding.
  NodeMatrix coupling(double ratio) const;
  /// Adds to out[m] the velocity in θ^m due to f(θ) = Σ_k force[k] θ^k on a step of that length.
  void add_forced_series(double ratio, const NodeVector& force, Series& out) const;
  /// Z at θh, h = ratio·series_step, under the same force.
  void advance_any(double ratio, double theta, const NodeVector& force, PlanarVector& state) const;
  /// Z after a grid step, or after any time [s] up to one, without force.
  void advance_free(PlanarVector& state);
  void advance_free_by(double time, PlanarVector& state);
  /// Σ |a λ^s||Z|, within a factor √2.
  double free_derivative_bound(const PlanarVector& state) const;
  MotionSample observe(const PlanarVector& state, MotionRequest wanted) const;

 private:
  enum Row : std::size_t { kVelocity, kDisplacement, kLeft, kRight, kRows };
  void fill_observed(const ContactModes& modes);
  void fill_series(const ContactModes& modes);
  SlidingTable make_table(double step) const;

  LobattoRule rule_;
  std::size_t modes_;
  double effective_mass_, grid_step_, series_step_;
  int first_level_ = 0;
  PlanarVector pole_;
  AlignedVector drive_;
  AlignedVector derivative_weight_;  // |a λ^s|
  PlanarRows observed_;
  PlanarRows series_;  // a (λ h₀)^p/p!
  // moment_[k][p] = k!/(p + k + 1)! Re Σ a d λ^p h₀^{p+1}: the velocity due to a force t^k.
  std::array<Series, kMaxNodes> moment_{};
  std::array<Octet, kSeriesTerms> moment_table_{};  // the same, p first
  double largest_pole_ = 0.0;
  std::vector<std::unique_ptr<SlidingTable>> tables_;
  PlanarVector free_factor_;
};

}  // namespace modcal::event
