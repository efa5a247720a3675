// Gain of the observer: the steady Kalman filter of the linear string.
#pragma once

#include "libinverse/observer/observer_kernel.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal::observer {

/// Steady correction gain K = P Hᵀ (H P Hᵀ + R)⁻¹, P the solution of the discrete Riccati equation
/// P = A [P − P Hᵀ (H P Hᵀ + R)⁻¹ H P] Aᵀ + q² B Bᵀ of the string without bow: A, B of one sample
/// with the force held (white force of standard deviation q [N] per sample), H the two reactions,
/// R = diag(noise²) [N²]. Solved by structure-preserving doubling (Chu, Fan and Lin, 2005, Linear
/// Algebra Appl. 396) in the modal coordinates Z/φ.
struct SteadyGain {
  GainTable gain;
  std::size_t doublings = 0;
  bool converged = false;
  /// ‖P − right-hand side‖/‖P‖ of the Riccati equation (Frobenius).
  double residual = 0.0;
  /// Mean over both reactions of the innovations' variance over that of the noise where the model
  /// is right and no force but the known one acts: (H P₀ Hᵀ + R)/R, P₀ = F P₀ Fᵀ + A K R Kᵀ Aᵀ, F =
  /// A (1 − K H). What the gain lets in of the noise is all that is above 1.
  double quiet_misfit = 1.0;
};

/// force_noise q > 0 [N], noise > 0 [N], sample_rate > 0 [Hz]. Throws InvalidInput otherwise.
SteadyGain steady_gain(const ModalBasis& basis, double contact, double sample_rate,
                       double force_noise, const double (&noise)[2]);

}  // namespace modcal::observer
