// The largest force that adherence can carry, where the contact cools while it sticks.
#pragma once

#include <cmath>
#include <optional>
#include <span>

#include "libsim/dynamics/friction/stateful_laws.hpp"

namespace modcal::event {

/// Static limit at load 1 [N] as a function of the time τ [s] of adherence: a constant, or
/// μ(ϑ₀ e^{−Gτ/H}) of a contact with a temperature. It never falls with τ.
class StaticLimit {
 public:
  StaticLimit(double force) : force_(force) {}  // NOLINT(google-explicit-constructor)
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

}  // namespace modcal::event
