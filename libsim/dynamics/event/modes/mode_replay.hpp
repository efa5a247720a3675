// The string's modes under a given force, by power series of their own.
#pragma once

#include <span>
#include <vector>

#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/dynamics/event/modes/gauss_rule.hpp"
#include "libsim/dynamics/event/modes/modal_kernels.hpp"

namespace modcal::event {

/// Modes Z' = λ Z + d f under forces given as power series in time. On a piece of length h each
/// mode is the series z_{p+1} = (λh z_p + h d f_p)/(p + 1), taken to where its rest is below
/// rounding; dissipation is integrated by Gauss's rule. None of the integrator's propagators is
/// used.
class ModeReplay {
 public:
  /// Longest piece, |λ|h; longer ones are for the caller to divide.
  static constexpr double kLongestPhase = 4.0;

  explicit ModeReplay(const ContactModes& modes);

  /// max |λ| [1/s].
  double fastest() const { return fastest_; }
  /// Moves on by `time` [s] under f(θ) = Σ force[k] θ^k, at most 25 coefficients. Returns the
  /// dissipation Σ ∫ 2ζω m p² dt [J] and writes v(θ) = Σ velocity[p] θ^p of the contact [m/s].
  double advance(double time, std::span<const double> force, std::vector<double>& velocity);
  /// Σ m (p² + ω² q²)/2 [J] of any state Z of these modes.
  double energy(const PlanarVector& state) const;
  const PlanarVector& state() const { return state_; }

 private:
  std::size_t terms(double phase, std::size_t forces) const;

  double fastest_ = 0.0;
  std::size_t modes_;
  PlanarVector pole_, state_;
  AlignedVector drive_, quadrature_, loss_;  // d, κ, 2ζω/d
  std::vector<double> compliance_;           // 1/ω_d
  GaussRule few_, many_;
};

}  // namespace modcal::event
