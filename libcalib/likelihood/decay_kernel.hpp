// Kernels of the free decays that a record leaves ringing: their Gram matrix from sums of one mode
// each, and their columns.
#pragma once

#include <span>

#include "libcalib/likelihood/likelihood_kernel.hpp"

namespace modcal {

/// Sums over the bins that give a mode's share of the Gram matrix, p the parity of the mode and
/// χ = conj(κ_odd) κ_even.
struct DecayPowers {
  Complex own, own_conj;  ///< Σ |κ_p|² U, Σ |κ_p|² U'
  Complex mixed, mixed_conj;  ///< Σ χ U, Σ χ U' of an even mode; conj(χ) in χ's place of an odd one
  double square = 0.0;        ///< Σ |κ_p|² |U|²
  double square_conj = 0.0;  ///< Σ |κ_p|² |U'|²
};
struct DecayTotals {
  double odd = 0.0, even = 0.0;  ///< Σ |κ_odd|², Σ |κ_even|²
  Complex mixed;                 ///< Σ χ
};

/// Adds the sums of one block; `powers`: one a mode.
void add_decay_powers(const WhitenedRecord& record, std::size_t block_index,
                      std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                      std::span<DecayPowers> powers, DecayTotals& totals);

/// Adds Re Σ conj(x) v and Re Σ conj(x') v of every mode to products[2n] and products[2n + 1], with
/// x = κ_n (U_n + U'_n), x' = iκ_n (U_n − U'_n) and a column v.
void add_decay_products(const WhitenedRecord& record, std::size_t block_index,
                        std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                        const double* column, double* products);

/// Fills odd_decay and even_decay of the block and, where `columns` is not null, x_n and x'_n of
/// every mode in turn.
void fill_decays(const WhitenedRecord& record, std::size_t block_index,
                 std::span<const LikelihoodMode> modes, std::span<const Complex> amplitudes,
                 LikelihoodBlock& block, double* columns);

}  // namespace modcal
