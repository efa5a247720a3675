// The modal model: what simulation, inversion and calibration share.
#pragma once

#include "libsim/model/string_model.hpp"

namespace modcal {

/// Modes of a pinned string, m_n (q̈_n + 2 ζ_n ω_n q̇_n + ω_n² q_n) = φ_n(x_c) f_c(t) with
/// φ_n(x) = sin(nπx/L), m_n = ρ_L L/2 (Debut, Delaune and Antunes, 2010, eqs. 2–4; its eq. 2 omits
/// m_n, its eq. 11 does not).
struct ModalBasis {
  double length = 0.0;        ///< L [m]
  double tension = 0.0;       ///< T [N]
  std::vector<double> omega;  ///< ω_n [rad/s]
  std::vector<double> zeta;   ///< ζ_n [1]
  std::vector<double> mass;   ///< m_n [kg]

  std::size_t size() const { return omega.size(); }
  double frequency(std::size_t index) const;  ///< ω_n/2π [Hz]
  /// φ_n(x) = sin(nπx/L) for all modes; 0 ≤ x ≤ L [m].
  std::vector<double> shape_at(double x) const;
};

/// f_n of all modes [Hz].
std::vector<double> frequencies_of(const ModalBasis& basis);

/// sin(nπξ), exact zeros at nodes: the argument is reduced to a fraction of a turn first, ξ = x/L.
double sine_shape(std::size_t n, double relative_position);

ModalBasis make_modal_basis(const StringModel& string);

/// The basis with other modal frequencies [Hz] and, with them, other damping left as ratios.
ModalBasis with_frequencies(ModalBasis basis, std::span<const double> frequencies);

}  // namespace modcal
