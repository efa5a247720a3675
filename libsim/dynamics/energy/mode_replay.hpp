// The string's modes under given contact forces, by power series of their own.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libsim/base/aligned_vector.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal {

/// Gauss–Legendre quadrature on [0, 1].
struct GaussRule {
  std::vector<double> node, weight;
};

/// n points, exact for polynomials of degree 2n − 1: the roots of P_n by Newton's method from
/// cos(π (i + ¾)/(n + ½)) (Abramowitz and Stegun, 1964, 25.4.30).
GaussRule gauss_rule(int points);

/// Coefficients of the powers of θ ∈ [0, 1], for one contact point each.
using PointPowers = std::vector<std::vector<double>>;

/// Modes Z' = λ Z + Σ_j φ_j f_j/m under forces given as power series in time. On a piece of length
/// h each mode is the series z_{p+1} = (λh z_p + h Σ_j φ_j f_jp/m)/(p + 1), taken to where its rest
/// is below rounding; dissipation is integrated by Gauss's rule. None of the simulators'
/// propagators is used.
class ModeReplay {
 public:
  /// Longest piece, |λ|h; longer ones are for the caller to divide.
  static constexpr double kLongestPhase = 4.0;

  explicit ModeReplay(const ContactModes& modes);
  explicit ModeReplay(const LineModes& modes);

  /// max |λ| [1/s].
  double fastest() const { return fastest_; }
  /// Moves on by `time` [s] under f_j(θ) = Σ force[j][k] θ^k, at most 25 coefficients. Returns the
  /// dissipation Σ ∫ 2ζω m p² dt [J] and writes v_j(θ) = Σ velocity[j][p] θ^p of the points [m/s].
  double advance(double time, std::span<const std::span<const double>> force,
                 PointPowers& velocity);
  /// Σ m (p² + ω² q²)/2 [J] of any state Z of these modes.
  double energy(const PlanarVector& state) const;
  const PlanarVector& state() const { return state_; }

 private:
  ModeReplay(const ModeTable& modes, const std::vector<double>& inverse_mass);
  std::size_t terms(double phase, std::size_t forces) const;

  double fastest_ = 0.0;
  std::size_t modes_;
  PlanarVector pole_, state_;
  AlignedVector inverse_mass_, quadrature_, loss_;  // 1/m, κ, 2ζωm
  std::vector<AlignedVector> shape_;
  std::vector<double> compliance_;  // 1/ω_d
  GaussRule few_, many_;
};

}  // namespace modcal
