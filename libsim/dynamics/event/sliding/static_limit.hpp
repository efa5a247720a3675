// The largest force that adherence can carry, where the contact cools while it sticks.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <span>

#include "libsim/dynamics/friction/sliding_laws.hpp"

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

// With p = 1/(1 + e^x) and x = (ϑ − ϑ_s)/w the limit is μ_hot + (μ_cold − μ_hot) p, and
// p' = −p (1 − p) x', x' = −g (ϑ/w): the powers of p follow one after the other.
inline void StaticLimit::series(double tau, double time, std::span<double> out) const {
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

}  // namespace modcal::event
