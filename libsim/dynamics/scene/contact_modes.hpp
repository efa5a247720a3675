// The string as the contact sees it: the modes that the contact force moves, one complex number
// each, and the spring, damper and limit of the contact itself.
#pragma once

#include <complex>

#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/dynamics/scene/simulation.hpp"

namespace modcal {

/// Modes in a variable Z = φ (p + ζω q + i ω_d q), p = q̇, ω_d = ω √(1 − ζ²), that obeys
/// Z' = λ Z + φ F, λ = −ζω + iω_d, under the modal acceleration F = Σ_j φ_j f_j/m.
struct ModeTable {
  /// Re(ḡ Z).
  static double reading(std::complex<double> gain, std::complex<double> z) {
    return gain.real() * z.real() + gain.imag() * z.imag();
  }
  std::vector<std::complex<double>> pole;  ///< λ [1/s]
  std::vector<double> quadrature;          ///< ζω/ω_d [1]
  std::vector<double> compliance;          ///< 1/ω_d [s]
  /// What two sensors read of Z, Re(ḡ Z) with φ = 1: of a string's ends g = i g_r/(φ ω_d) [N s/m].
  std::vector<std::complex<double>> left_gain, right_gain;
  std::vector<std::complex<double>> initial;  ///< Z at t = 0 [m/s]

  std::size_t size() const { return pole.size(); }
  /// What the state Z of mode n is of the contact's motion and the reactions, with φ = 1.
  MotionSample motion(std::size_t n, std::complex<double> z) const {
    return {.displacement = compliance[n] * z.imag(),
            .velocity = z.real() - quadrature[n] * z.imag(),
            .left = reading(left_gain[n], z),
            .right = reading(right_gain[n], z)};
  }
};

/// As one contact point sees them, φ its shape: displacement of the contact y = Σ Im Z/ω_d,
/// velocity v = Σ (Re Z − ζω/ω_d Im Z), reaction R_r = Σ g_r/(φ ω_d) Im Z. Modes with a node at the
/// contact (|φ_n| ≤ 1e-13, the rounding of nπx_c/L for n up to 1000) are left out where they are at
/// rest: no force reaches them and the contact does not see them. One that moves initially is
/// carried with φ = 1e-20, so that it decays freely and reaches the ends, while its part of the
/// contact's motion and of the force is below rounding.
struct ContactModes : ModeTable {
  std::vector<double> drive;          ///< φ²/m [1/kg]
  std::vector<std::size_t> left_out;  ///< modes of the basis that are not here, from 0

  /// Adds modes that the same contact force drives.
  void append(const ContactModes& other);
  /// Effective mass at the contact m_eff = 1/Σ φ²/m [kg].
  double effective_mass() const;
};

/// As several points see them, φ = 1: y_j = Σ φ_j Im Z/ω_d, v_j = Σ φ_j (Re Z − ζω/ω_d Im Z),
/// R_r = Σ g_r/ω_d Im Z. Transverse modes first, then the torsional ones, which have no reactions.
/// Transverse modes with a node at every point that are at rest are left out.
struct LineModes : ModeTable {
  std::vector<double> inverse_mass;        ///< 1/m [1/kg]
  std::vector<std::vector<double>> shape;  ///< φ_j, points × modes

  std::size_t points() const { return shape.size(); }
  /// m_eff = 1/Σ φ²/m [kg] at the middle of the points, as the mean over them.
  double effective_mass() const;
};

/// Whether a mode with this shape at the contact has a node there but for rounding.
bool is_node(double shape);

/// Throws InvalidInput where no mode moves at the contact.
ContactModes contact_modes(const ModalBasis& basis, double contact, const ModalState& initial);

/// Motion of the contact and reactions of the ends in the state Z of the modes.
MotionSample motion_of(const ContactModes& modes, const std::vector<std::complex<double>>& state);

/// The modes of the scene's string as one contact point sees them, the torsional ones last, or
/// those of its structure. Throws InvalidInput for a bow with several contact points.
ContactModes scene_modes(const Scene& scene);

/// The same as all contact points of the bow see them. Throws InvalidInput for a point outside the
/// string.
LineModes scene_line_modes(const Scene& scene);

struct ContactParameters {
  double bow_velocity = 0.0;  ///< [m/s]
  double static_limit = 0.0;  ///< μ_S F_N [N]
  double stiffness = 0.0;     ///< K_a [N/m]
  double damping = 0.0;       ///< C_a [N s/m]
};

/// Contact of the scene under a bow that moves as at t = 0; a near-critical adherence damping
/// becomes C_a = 2 √(K_a m_eff).
ContactParameters contact_parameters(const BowMotion& motion, const FrictionLaw& friction,
                                     double effective_mass);

}  // namespace modcal
