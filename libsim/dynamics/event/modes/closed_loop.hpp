// The string held by the contact's spring and damper: a linear system in its own coordinates.
#pragma once

#include "libsim/dynamics/event/modes/modal_kernels.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal::event {

/// Real-linear map between complex vectors whose matrix is a product of poles' differences:
/// out_j = p_j Σ_n A_n M_nj + q_j Σ_n B_n M_nj with A = Re(a ∘ in), B = Re(b ∘ in).
/// Where the matrix would not fit into the caches (or the memory) it is computed entry by entry
/// from the poles λ of the open loop and the roots μ = anchor + offset of the closed one, which
/// costs no more than reading it: 1/((μ − λ)(μ − λ̄)) towards the roots, 1/((λ − μ)(λ − μ̄)) towards
/// the poles.
struct PoleMap {
  PlanarVector a, b;
  PlanarRows matrix;  ///< one row an input; empty: computed
  PlanarVector p, q;
  bool towards_roots = false;
  PlanarVector pole, anchor, offset;   ///< of a computed matrix
  AlignedVector scratch_a, scratch_b;  ///< A and B of the running call
};

/// out = the map of the first `inputs` numbers of `in`; `out` is as long as `p`.
void apply(PoleMap& map, std::size_t inputs, const PlanarVector& in, PlanarVector& out);

/// A force f(τ) = f₀ + f₁τ + ½f₂τ² [N].
struct SlowForce {
  double start = 0.0;      ///< f₀ [N]
  double rate = 0.0;       ///< f₁ [N/s]
  double curvature = 0.0;  ///< f₂ [N/s²]

  double value_at(double tau) const { return start + (rate + 0.5 * curvature * tau) * tau; }
  double rate_at(double tau) const { return rate + curvature * tau; }
};

/// Answer of the string to a slow force after all transients:
/// x = value·f + rate·f' + curvature·f''.
struct QuasiStatic {
  double value = 0.0;
  double rate = 0.0;
  double curvature = 0.0;

  double at(const SlowForce& force, double tau) const {
    return value * force.value_at(tau) + rate * force.rate_at(tau) + curvature * force.curvature;
  }
};

/// Adherence f = −K (y − y_a − v_b τ − ½a τ²) − C (v − v_b − a τ) closes the loop around Z' = λ Z +
/// d f. With the roots μ_j of 1 + (K + C s) G(s) and w' = μ w the homogeneous motion is
///   f = Re Σ w_j,  f' = Re Σ μ_j w_j,  v = −Re Σ μ_j w_j/(K + C μ_j),
///   Z_n = ½ d_n Σ_j [w_j/(μ_j − λ_n) + w̄_j/(μ̄_j − λ_n)],
/// and the bow's motion adds a slow force, Z = −(d/λ) f − (d/λ²) f' − (d/λ³) f''. Eigenvectors in
/// closed form: no dense eigenproblem.
struct ClosedLoop {
  enum Row : std::size_t { kVelocity, kLeft, kRight, kRows };

  std::size_t modes = 0;
  std::size_t roots = 0;
  PlanarVector pole;           ///< μ_j [1/s]
  double largest_pole = 0.0;   ///< max |μ_j|
  PlanarRows observed;         ///< rows giving v, R₁, R₂ of the homogeneous motion
  PoleMap to_closed, to_open;  ///< Z → w and w → Z
  /// Z and w of a slow force: −d/λ, −d/λ², −d/λ³, to be multiplied by f, f', f''.
  std::array<PlanarVector, 3> open_slow, closed_slow;
  QuasiStatic displacement, left, right;
  double stiffness = 0.0, damping = 0.0;

  /// The slow force of a bow with v_b [m/s] at τ = 0 and acceleration a [m/s²], whose spring rests
  /// at y_a [m] at τ = 0: with y = S₀ f + S₁ f' + S₂ f'' the powers of τ in adherence give
  ///   (1 + K S₀) f₂ = K a,   (1 + K S₀) f₁ = K v_b + C a − (K S₁ + C S₀) f₂,
  ///   (1 + K S₀) f₀ = K y_a + C v_b − (K S₁ + C S₀) f₁ − (K S₂ + C S₁) f₂.
  SlowForce slow_force(double bow_velocity, double bow_acceleration, double rest_point) const;

  /// e^{μ_j time}.
  PlanarVector propagator(double time) const;
};

/// Nothing where the roots are not found, or two are so close that the coordinates lose more than 8
/// digits.
std::optional<ClosedLoop> make_closed_loop(const ContactModes& modes, double stiffness,
                                           double damping);

}  // namespace modcal::event
