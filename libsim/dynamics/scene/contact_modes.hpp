// The string as the contact sees it: the modes that the contact force moves, one complex number
// each.
#pragma once

#include <complex>
#include <vector>

#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Modes in the variable Z = φ (p + ζω q + i ω_d q), p = q̇, with Z' = λ Z + (φ²/m) f and
/// λ = −ζω + iω_d, ω_d = ω √(1 − ζ²): displacement of the contact y = Σ Im Z/ω_d, velocity
/// v = Σ (Re Z − ζω/ω_d Im Z), reaction R_r = Σ g_r/(φ ω_d) Im Z.
/// Modes with a node at the contact (|φ_n| ≤ 1e-13, the rounding of nπx_c/L for n up to 1000) are
/// left out where they are at rest: no force reaches them and the contact does not see them. One
/// that moves initially is carried with φ = 1e-20, so that it decays freely and reaches the ends,
/// while its part of the contact's motion and of the force is below rounding.
struct ContactModes {
  std::vector<std::complex<double>> pole;     ///< λ [1/s]
  std::vector<double> drive;                  ///< φ²/m [1/kg]
  std::vector<double> quadrature;             ///< ζω/ω_d [1]
  std::vector<double> compliance;             ///< 1/ω_d [s]
  std::vector<double> left_gain;              ///< g₁/(φ ω_d) [N s/m]
  std::vector<double> right_gain;             ///< g₂/(φ ω_d) [N s/m]
  std::vector<std::complex<double>> initial;  ///< Z at t = 0 [m/s]
  std::vector<std::size_t> left_out;          ///< modes of the basis that are not here, from 0

  std::size_t size() const { return pole.size(); }
  /// Adds modes that the same contact force drives.
  void append(const ContactModes& other);
  /// Effective mass at the contact m_eff = 1/Σ φ²/m [kg].
  double effective_mass() const;
};

/// Whether a mode with this shape at the contact has a node there but for rounding.
bool is_node(double shape);

ContactModes contact_modes(const ModalBasis& basis, double contact, const ModalState& initial);

}  // namespace modcal
