// Kernel of the modal sum: no allocation, instruction set chosen at run time.
#pragma once

#include <span>

#include "libsim/signal/fft.hpp"

namespace modcal {

/// One mode of a transfer function: residue/(ω_n² + s² + 2ζ_nω_n s).
struct ModalTerm {
  double residue = 0.0;
  double omega_squared = 0.0;
  double two_zeta_omega = 0.0;
};

/// out_k = Σ_n residue_n/(ω_n² + s_k² + 2ζ_nω_n s_k), s_k = σ + i k·spacing.
/// Floor: one division, 8 multiply-adds per term and bin.
void sum_modal_terms(std::span<const ModalTerm> terms, double spacing, double sigma,
                     std::span<Complex> out);

}  // namespace modcal
