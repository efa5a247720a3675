// The string held by the contact's spring and damper: a linear system in its own coordinates.
#pragma once

#include <optional>

#include "libsim/dynamics/contact_modes.hpp"
#include "libsim/dynamics/event/modal_kernels.hpp"

namespace modcal::event {

/// Answer of the string to a force f₀ + f₁τ after all transients: x = value·(f₀ + f₁τ) + rate·f₁.
struct QuasiStatic {
  double value = 0.0;
  double rate = 0.0;
};

/// Adherence f = −K (y − y_a − v_b τ) − C (v − v_b) closes the loop around Z' = λ Z + d f. With the
/// roots μ_j of 1 + (K + C s) G(s) and w' = μ w the homogeneous motion is
///   f = Re Σ w_j,  f' = Re Σ μ_j w_j,  v = −Re Σ μ_j w_j/(K + C μ_j),
///   Z_n = ½ d_n Σ_j [w_j/(μ_j − λ_n) + w̄_j/(μ̄_j − λ_n)],
/// and the bow's steady motion adds f₀ + f₁τ, Z = −(d/λ)(f₀ + f₁τ) − (d/λ²) f₁, with
/// f₁ = K v_b/(1 + K S), S = G(0). Eigenvectors in closed form: no dense eigenproblem.
struct ClosedLoop {
  enum Row : std::size_t { kVelocity, kLeft, kRight, kRows };

  std::size_t modes = 0;
  std::size_t roots = 0;
  PlanarVector pole;            ///< μ_j [1/s]
  double largest_pole = 0.0;    ///< max |μ_j|
  PlanarRows observed;          ///< rows giving v, R₁, R₂ of the homogeneous motion
  PoleMap to_closed, to_open;   ///< Z → w and w → Z
  PlanarVector constant, ramp;  ///< w of −d/λ and of −d/λ²
  PlanarVector open_constant;   ///< −d/λ
  PlanarVector open_ramp;       ///< −d/λ²
  QuasiStatic displacement, left, right;
  double stiffness = 0.0, damping = 0.0;

  /// f₁ [N/s] for the bow velocity v_b.
  double force_rate(double bow_velocity) const;
  /// f₀ [N] for the rest point y_a of the spring.
  double force_offset(double bow_velocity, double rest_point) const;
};

/// Nothing where the roots are not found, or two are so close that the coordinates lose more than 8
/// digits.
std::optional<ClosedLoop> make_closed_loop(const ContactModes& modes, double stiffness,
                                           double damping);

}  // namespace modcal::event
