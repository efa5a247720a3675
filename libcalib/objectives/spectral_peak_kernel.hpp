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
/// of kBandLanes changes no bit. Four terms share a division.
void add_up_terms(std::span<const TwoSidedTerm> terms, double spacing, const TwoSidedSums& sums);

/// The band of one mode, ready for candidates.
struct CandidateBand {
  TwoSidedSums rest;  ///< without the mode, `bins` of them a multiple of kBandLanes
  /// |R_r| per bin, 0 beyond the band; null: the reaction is missing.
  std::array<const double*, 2> magnitude{};
  const double* omega = nullptr;  ///< ω_k [rad/s]
  TwoSidedTerm term;              ///< the mode; its ω_n is not used
};

/// integrals_j = Σ_k Σ_r |R_r| |D| / |rest_r D + a_r| with D at ω_n = candidates_j [rad/s]: the sum
/// of |F_r| over the band. Floor with both reactions: a division, a square root and an inverse root
/// per bin and candidate.
void integrate_candidates(const CandidateBand& band, std::span<const double> candidates,
                          std::span<double> integrals);

}  // namespace modcal
