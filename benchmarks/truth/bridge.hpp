// The end at x = L on a mode of the body.
#pragma once

#include <complex>
#include <vector>

#include "benchmarks/truth/truth.hpp"

namespace modcal::truth {

/// y(x, t) = w(x, t) + u(t) x/L, w pinned at both ends. The chord u x/L needs no force inside the
/// string but for its inertia, so that w has the load −ρ ü x/L, and the bridge
///
///     m (ü + 2ζω_r u̇ + ω_r² u) = −T u/L − T w'(L) + EI w'''(L).
///
/// The load is put on the grid by its exact sines, x/L = Σ 2(−1)^{n+1}/(nπ) sin nπx/L to n = N − 1:
/// its points alone would have an error of order (n/N)².
class Bridge {
 public:
  Bridge(const TruthString& string, const TruthMismatch& mismatch, const WaveGrid& grid);

  /// ü [m/s²] where the support force of the pinned string at x = L, T w' − EI w''', is this [N].
  double acceleration(double support_force) const;
  void advance(double acceleration);
  /// ρ h x/L at the points [kg]: −ü times this is the load of w.
  const std::vector<double>& load() const { return load_; }
  double displacement() const { return u_; }  ///< u [m]
  /// u̇ between the last two changes [m/s], as Wave's velocity at the contact.
  double velocity() const { return (change_ + last_change_) / (2.0 * step_); }

  /// Modes of string and bridge by those of the pinned string: zeros s of
  ///
  ///     m (s² + 2ζω_r s + ω_r²) + T/L + (2/L) s² Σ_n (T + EI (nπ/L)²)/(ω_n² + 2σ_n s + s²),
  ///
  /// of each n the one next to its own. Throws std::invalid_argument where the bridge's mode is too
  /// near for one to be found.
  std::vector<WaveMode> coupled(const std::vector<WaveMode>& pinned) const;

 private:
  double support_gain(std::size_t n) const;  ///< T + EI (nπ/L)² [N]

  double mass_, omega_, damping_, length_, tension_, bending_, step_;
  std::vector<double> load_;
  double u_ = 0.0, change_ = 0.0, last_change_ = 0.0;
};

}  // namespace modcal::truth
