// Kernels of the free decays that a record leaves ringing: their Gram matrix from sums of one mode
// each, their sums and their columns.
#pragma once

#include <span>

#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"

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

/// Sums kept lane by lane: this many numbers a sum.
/// Fixed by: doubles in the widest vector in use.
inline constexpr std::size_t kSumLanes = 8;
/// Sums of add_decay_powers() a mode.
/// Fixed by: sums that add_decay_powers() is written for.
inline constexpr std::size_t kPowerSums = 10;
/// Columns that add_decay_products() takes at most, with two sums each a mode.
/// Fixed by: length of the kernel's arrays; more columns are taken in parts.
inline constexpr std::size_t kDecayColumns = 8;

/// Adds the sums of one block, kPowerSums of kSumLanes numbers a mode.
void add_decay_powers(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                      const LikelihoodBlock& block, double* sums, DecayTotals& totals);
void collect_decay_powers(const double* sums, std::span<DecayPowers> powers);

/// Adds Re Σ conj(x) v and Re Σ conj(x') v of every mode and each of `count` columns v to two sums
/// of kSumLanes numbers, first by mode, then by column, with x = κ_n (U_n + U'_n) and
/// x' = iκ_n (U_n − U'_n).
void add_decay_products(const WhitenedRecord& record, std::size_t block_index,
                        const ModeSplit& split, const LikelihoodBlock& block, const double* columns,
                        std::size_t count, double* sums);
/// products[2n·count + v] for x_n, products[(2n + 1)·count + v] for x'_n.
void collect_decay_products(const double* sums, std::size_t modes, std::size_t count,
                            double* products);

/// Fills odd_decay and even_decay of the block.
void fill_decays(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                 std::span<const Complex> amplitudes, LikelihoodBlock& block);
/// Fills the columns x_n and x'_n of the modes in a list in turn.
void fill_decay_columns(const WhitenedRecord& record, std::size_t block_index,
                        std::span<const LikelihoodMode> modes, std::span<const std::size_t> list,
                        const LikelihoodBlock& block, double* columns);
/// column −= Σ_n κ_n (a_n U_n + conj(a_n) U'_n).
void subtract_decays(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                     std::span<const Complex> amplitudes, const LikelihoodBlock& block,
                     double* column);

}  // namespace modcal
