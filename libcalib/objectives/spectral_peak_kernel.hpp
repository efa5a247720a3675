// Kernels of the spectral-peak integral: no allocation, instruction set chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "libcalib/objectives/two_sided_terms.hpp"

namespace modcal {

/// Real and imaginary parts of the sums over modes at both ends, one array each, and consecutive
/// bins from `first_bin`.
struct TwoSidedSums {
  std::array<double*, 2> real{};
  std::array<double*, 2> imag{};
  std::size_t first_bin = 0;
  std::size_t bins = 0;
};

/// Arrays of a band are padded to a multiple of this many bins.
inline constexpr std::size_t kBandLanes = 8;

/// sums_r(ω_k) = Σ a_rn/D_n(ω_k). Every bin is computed by itself: splitting the range at multiples
/// of kBandLanes changes no bit.
void add_up_terms(std::span<const TwoSidedTerm> terms, double spacing, const TwoSidedSums& sums);

/// sums_r += a_r (1/D_new − 1/D_old), of two terms with equal residues. Floor: one division a bin.
void move_term(const TwoSidedTerm& from, double new_omega, double spacing,
               const TwoSidedSums& sums);

/// rest_r = sums_r − a_r/D for the bins of `rest`, which lie within those of `sums`; zeros up to
/// the padded size.
void leave_out_term(const TwoSidedTerm& term, double spacing, const TwoSidedSums& sums,
                    const TwoSidedSums& rest);

/// The band of one mode, ready for candidates.
struct CandidateBand {
  TwoSidedSums rest;                         ///< without the mode, padded
  std::array<const double*, 2> magnitude{};  ///< |R_r| per bin, zeros in the padding; null: the
                                             ///< reaction is missing
  TwoSidedTerm term;                         ///< the mode; its ω_n is not used
  double spacing = 0.0;                      ///< [rad/s]
};

/// integrals_j = Σ_k Σ_r |R_r| |D| / |rest_r D + a_r| with D at ω_n = candidates_j [rad/s]: the sum
/// of |F_r| over the band. Floor with both reactions: one division and two square roots per bin and
/// candidate.
void integrate_candidates(const CandidateBand& band, std::span<const double> candidates,
                          std::span<double> integrals);

}  // namespace modcal
