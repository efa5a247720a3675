// One-step coefficients of the fixed-step loop, in the coordinates in which a step is cheapest.
#pragma once

#include "libsim/base/aligned_vector.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal {

/// One-step weights of a mode with the step h > 0 [s], r, d₀ (of the older force) and d₁ (of the
/// newer one): Z(h) = r Z + drive·(d₀ f_old + d₁ f_new).
struct ModeWeights {
  std::complex<double> propagate, older, newer;
};
/// Those of all modes.
using SchemeWeights = std::vector<ModeWeights>;

/// A sum over the modes, Σ first x₁ + second x₂; `kick` = Σ second is what a force that x₂ does not
/// hold yet adds to it.
struct ModeSum {
  AlignedVector first, second;
  double kick = 0.0;
};

/// With S = Z without the part d₁ f_new of the newest force and u = the force before it,
///   S_{k+1} = r S_k + D u,  D = drive (r d₁ + d₀),     P = r S,   Z = S + d₁ f_new.
/// P follows P ← r P + G u, G = r D. Written P = G ((1 − r̄) x₁ + x₂) with real x₁ and x₂ that is
///   x₂ ← x₂ + u,   x₁ ← x₁ + x₂,   x₂ ← d x₂ − a x₁,     d = |r|², a = |1 − r|²:
/// two products a mode where a matrix and a force need six, and a sum over the modes takes two more
/// for the one quantity that the contact asks for. x₁ and x₂ are padded to whole vectors.
struct StepCoefficients {
  AlignedVector decay, turn;    ///< d, a [1]
  AlignedVector first, second;  ///< x₁, x₂ of P [N], overwritten by the loop
  /// Of P: velocity [m/s] and displacement [m] of the contact, reactions [N].
  ModeSum velocity, displacement, left, right;
  ModeSum held;  ///< stiffness·displacement + damping·velocity, set by hold()
  // Σ over modes: response of velocity, displacement and reactions to D and to d₁.
  MotionSample deferred_response, direct_response;

  /// Makes `held` the force of a spring [N/m] and a damper [N s/m] at the contact.
  void hold(double stiffness, double damping);
};

/// Whether x₁ and x₂ can be told apart, |Im r| ≥ 0.05 |1 − r|, and forces reach them,
/// |r d₁ + d₀| ≥ 1e-3 (|d₀| + |d₁|), for every mode: not where a mode does a whole number of half
/// turns a step, nor where it is damped nearly critically.
bool are_separable(const SchemeWeights& weights);

/// `initial_force` is f_new of t = 0. Modes must be separable.
StepCoefficients make_step_coefficients(const ContactModes& modes, const SchemeWeights& weights,
                                        double initial_force);

}  // namespace modcal
