// Poles of the string while it sticks: the roots of a rational function whose poles are known.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace modcal::event {

/// One open-loop mode: pole λ with Im λ > 0 [1/s], drive d = φ²/m [1/kg].
struct OpenLoopMode {
  std::complex<double> pole;
  double drive;
};

/// Root μ of 1 + (K + C s) G(s), G(s) = Σ d/((s − λ)(s − λ̄)), held as the offset from one of the
/// poles: μ − λ_n keeps its digits where a weakly driven mode hardly moves.
class SecularRoot {
 public:
  SecularRoot() = default;
  SecularRoot(std::complex<double> anchor, std::complex<double> offset)
      : anchor_(anchor), offset_(offset) {}
  std::complex<double> value() const { return anchor_ + offset_; }
  /// μ − pole, for a pole of the open loop or its conjugate.
  std::complex<double> minus(std::complex<double> pole) const { return (anchor_ - pole) + offset_; }
  std::complex<double> minus(const SecularRoot& other) const {
    return (anchor_ - other.anchor_) + (offset_ - other.offset_);
  }
  std::complex<double> offset() const { return offset_; }
  std::complex<double> anchor() const { return anchor_; }
  void move(std::complex<double> change) { offset_ += change; }
  SecularRoot conjugate() const { return {std::conj(anchor_), std::conj(offset_)}; }
  bool is_real() const { return real_; }
  /// Declares the root real: its imaginary part is rounding.
  SecularRoot as_real() const;

 private:
  std::complex<double> anchor_;
  std::complex<double> offset_;
  bool real_ = false;
};

/// Roots of 1 + (K + C s) G(s) with Im μ ≥ 0; a real root is listed once, a complex one stands for
/// its conjugate too. K [N/m] > 0, C [N s/m] ≥ 0. Ehrlich–Aberth iteration on the numerator
/// (Aberth, 1973; Bini, 1996), which never forms the polynomial's coefficients. Nothing where it
/// does not converge to 2N roots with the trace of the system, as at a double root.
std::optional<std::vector<SecularRoot>> secular_roots(std::span<const OpenLoopMode> modes,
                                                      double stiffness, double damping);

}  // namespace modcal::event
