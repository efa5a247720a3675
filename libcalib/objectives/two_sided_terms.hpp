// The modal terms of the transfer functions to both ends.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "libcalib/parameters/parameters.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

/// One mode in the transfer functions to both ends: a_r/D(ω) with a_r = g_rn φ_n(x_c)/m_n and
/// D(ω) = ω_n² − ω² + 2iζ_nω_nω.
struct TwoSidedTerm {
  std::array<double, 2> residue{};  ///< a_1, a_2
  double omega = 0.0;               ///< ω_n [rad/s]
  double zeta = 0.0;                ///< ζ_n [1]

  Complex denominator(double at) const {
    return {(omega - at) * (omega + at), 2.0 * zeta * omega * at};
  }
  /// d(1/D)/dω_n at ω.
  Complex inverse_slope(double at) const {
    const Complex d = denominator(at);
    return -Complex(2.0 * omega, 2.0 * zeta * at) / (d * d);
  }
};

/// Terms of H_1 and H_2 (Debut, Delaune and Antunes, 2010, eq. 11).
std::vector<TwoSidedTerm> two_sided_terms(const ModelPoint& point);
/// Terms of ∂H_1/∂x_c and ∂H_2/∂x_c: φ_n replaced by dφ_n/dx = (nπ/L) cos(nπx/L).
std::vector<TwoSidedTerm> contact_slope_terms(const ModelPoint& point);

}  // namespace modcal
