// One wave equation on a grid between pinned ends, advanced by an explicit finite-difference
// scheme.
#pragma once

#include <cstddef>
#include <vector>

#include "benchmarks/truth/stencil.hpp"

namespace modcal::truth {

/// y_tt = c² y_xx − κ² y_xxxx − 2 σ₀ y_t + 2 σ₁ y_txx + f δ(x − x_c)/ρ, y = y_xx = 0 at both ends:
/// the stiff string with losses that grow with the square of the wavenumber (Bilbao, 2009,
/// Numerical Sound Synthesis, §7.2 and §7.3). With κ = 0 also the torsion of a string.
struct WaveEquation {
  double length = 0.0;     ///< L [m]
  double density = 0.0;    ///< ρ [kg/m]
  double speed = 0.0;      ///< c [m/s]
  double stiffness = 0.0;  ///< κ = √(EI/ρ) [m²/s]
  double loss = 0.0;       ///< σ₀ [1/s]
  double diffusion = 0.0;  ///< σ₁ [m²/s]
};

/// Grid of `intervals` cells and time step of a scheme.
struct WaveGrid {
  std::size_t intervals = 0;        ///< N
  double time_step = 0.0;           ///< k [s]
  std::size_t half_width = 8;       ///< P of the stencil of the elastic forces: 2, 4 or 8
  std::size_t loss_half_width = 4;  ///< Q of that of the losses; P/2
};

/// A mode of the scheme: decay σ and angular frequency of its poles s = −σ ± i√(ω² − σ²).
struct WaveMode {
  double omega = 0.0;  ///< |s| [rad/s]
  double decay = 0.0;  ///< σ [1/s]
};

/// Explicit two-level scheme with the displacement y^n and its last change d^n = y^n − y^{n−1},
///
///     d^{n+1} = d^n − C d^n − E y^n + g f^n l,    y^{n+1} = y^n + d^{n+1},
///
/// C and E symmetric stencils, l the weights of the contact's interpolation, g = k²/ρh but for
/// O(σ₀k). In the form with d rounding is relative to the change of a step and not to y.
///
/// A sine of the grid, θ = nπ/N, obeys z² − (2 − C(θ) − E(θ)) z + 1 − C(θ) = 0. The wave equation
/// asks for z = exp(sk) with s² + 2σs + ω² = 0, σ = σ₀ + σ₁β², ω² = c²β² + κ²β⁴, which is
///
///     C = 1 − exp(−2σk),    E = 1 + exp(−2σk) − 2 exp(−σk) cos(k√(ω² − σ²)).
///
/// The stencils are these symbols' power series in θ² cut off after θ^{2P} and θ^{2Q}
/// (matched_stencil): to lowest order in k Bilbao's explicit scheme with central differences of
/// order 2P, to higher orders the modified-equation correction of the time step (Shubin and Bell,
/// 1987; Dablain, 1986), so that error in time and in space vanish together with h^{2P−2} (h^{2P}
/// where κ = 0).
///
/// About pinned ends y is odd, y_{−j} = −y_j: sines stay exact eigenvectors next to the ends, and
/// mode() is exact for the scheme.
///
/// Energy: with M = 1/g (the mass ρh of a point over k²)
///     H^{n+1} = M/2 (|d^{n+1}|² + ⟨y^{n+1}, E y^n⟩),
///     H^{n+1} − H^n = f^n (d_c^n + d_c^{n+1})/2 − M ⟨(d^n + d^{n+1})/2, C d^n⟩
/// hold exactly (Bilbao, 2009, §6.2: the same with the stencils of second order): a force that
/// reacts to the velocity v^n = (d_c^n + d_c^{n+1})/2k gives and takes what it does.
class Wave {
 public:
  /// Throws std::invalid_argument where a mode of the scheme is unstable, the grid has fewer than
  /// 4 P cells or the half-widths are not among (2, 1), (4, 2), (8, 4).
  Wave(const WaveEquation& equation, const WaveGrid& grid);

  /// The next d and y without the contact's force.
  void advance();
  /// Adds its part, the force f [N] at the contact between the last two levels.
  void push(const Interpolation& contact, double force);
  /// The same of a load on all points 0 … N, h times its density [N], by a factor.
  void push_everywhere(const std::vector<double>& load, double factor);

  /// Sets the tension to (1 + relative) times that of the equation, |relative| << 1, for the
  /// steps to come. mode() stays that of the equation; the balance of energy lacks what this does.
  void retune(double relative);

  const WaveEquation& equation() const { return equation_; }
  const WaveGrid& grid() const { return grid_; }
  double spacing() const { return equation_.length / static_cast<double>(grid_.intervals); }
  /// g [m/N]: change of a step, shared out by l, per force. It makes static answers exact: the
  /// tension is that of the stencil's leading term.
  double response() const { return response_; }
  /// dv_c/df [m/s/N] of one step: g |l|²/2k.
  double mobility(const Interpolation& contact) const;
  /// 1 … N − 1.
  WaveMode mode(std::size_t n) const;

  /// Points 0 … N, with ghost points around them.
  const double* y() const { return y_.data() + margin_; }
  const double* change() const { return change_.data() + margin_; }
  const double* last_change() const { return last_change_.data() + margin_; }
  /// Sets displacement [m] at points 0 … N, at rest.
  void set_rest(const std::vector<double>& displacement);

  /// H of the last level [J].
  double energy() const;
  /// What the losses took in the last step [J].
  double lost() const;

 private:
  void mirror(std::vector<double>& values) const;
  double* inner(std::vector<double>& values) const { return values.data() + margin_; }

  WaveEquation equation_;
  WaveGrid grid_;
  std::size_t margin_;
  SymmetricStencil elastic_, losing_;
  std::vector<double> tuned_, slope_;  ///< taps of E as they are used, and their slope by tension
  double response_ = 0.0;
  std::vector<double> y_, change_, last_y_, last_change_;
};

}  // namespace modcal::truth
