// Exact step of one mode whose force is linear over the step.
#pragma once

#include <complex>

#include "libsim/dynamics/fixed_step/fixed_step.hpp"

namespace modcal {

/// Weights of Z(h) = r Z + d₀ f_old + d₁ f_new for Z' = λ Z + f(t): r = e^x, d₀ = h (φ₁ − φ₂),
/// d₁ = h φ₂ with φ₁ = (eˣ − 1)/x, φ₂ = (eˣ − 1 − x)/x², x = λh; λ `pole` [1/s], h `time_step` > 0
/// [s] (Cox and Matthews, 2002, J. Comput. Phys. 176, second-order exponential differencing).
ModeWeights first_order_hold_weights(std::complex<double> pole, double time_step);

}  // namespace modcal
