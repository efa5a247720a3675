// The string as several contact points see it.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "libsim/dynamics/scene/initial_motion.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Modes in the variable Z = p + ζω q + i ω_d q, p = q̇, with Z' = λ Z + Σ_j φ_j f_j/m: displacement
/// of point j y_j = Σ φ_j Im Z/ω_d, velocity v_j = Σ φ_j (Re Z − ζω/ω_d Im Z), reaction
/// R_r = Σ g_r/ω_d Im Z. Transverse modes first, then the torsional ones, which have no reactions.
/// Transverse modes with a node at every point that are at rest are left out.
struct LineModes {
  std::vector<std::complex<double>> pole;     ///< λ [1/s]
  std::vector<double> inverse_mass;           ///< 1/m [1/kg]
  std::vector<double> quadrature;             ///< ζω/ω_d [1]
  std::vector<double> compliance;             ///< 1/ω_d [s]
  std::vector<double> left_gain;              ///< g₁/ω_d [N s/m]
  std::vector<double> right_gain;             ///< g₂/ω_d [N s/m]
  std::vector<std::complex<double>> initial;  ///< Z at t = 0 [m/s]
  std::vector<std::vector<double>> shape;     ///< φ_j, points × modes

  std::size_t size() const { return pole.size(); }
  std::size_t points() const { return shape.size(); }
  /// m_eff = 1/Σ φ²/m [kg] at the middle of the points, as the mean over them.
  double effective_mass() const;
};

LineModes line_modes(const ModalBasis& transverse, const ModalBasis& torsional,
                     std::span<const double> positions, const ModalState& initial);

}  // namespace modcal
