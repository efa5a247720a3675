// Kernels of the Jacobian's columns of frequencies, damping and contact, and of their products with
// the residual.
#pragma once

#include <span>

#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"

namespace modcal {

/// Columns that fill_shared_columns() takes at most.
/// Fixed by: length of the kernel's arrays; more columns are filled mode by mode.
inline constexpr std::size_t kSharedColumns = 8;
/// Sums of add_mode_slopes() a mode, kSumLanes numbers each.
/// Fixed by: sums that add_mode_slopes() is written for.
inline constexpr std::size_t kSlopeSums = 5;

struct ColumnTask {
  std::span<const Complex> by_frequency;  ///< c_n ∂E_n/∂ln ω_n; empty: no end state
  std::span<const Complex> by_damping;    ///< c_n ∂E_n/∂ln ζ_n
  std::span<const ColumnShare> shares;  ///< [share_begin[n] … share_begin[n+1]) belong to mode n
  std::span<const std::size_t> share_begin;
  std::size_t count = 0;  ///< columns
  std::size_t contact = static_cast<std::size_t>(-1);
  double* jacobian = nullptr;  ///< columns of this block, added to
};
/// Mode by mode: for columns that few modes share.
void fill_mode_columns(const WhitenedRecord& record, std::size_t block_index,
                       std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                       const ColumnTask& task);
/// The same for up to kSharedColumns columns that many modes share: sums over the modes first.
void fill_shared_columns(const WhitenedRecord& record, std::size_t block_index,
                         const ModeSplit& split, const LikelihoodBlock& block,
                         const ColumnTask& task);

/// Products of the residual with what one mode adds to the Jacobian.
struct ModeSlopes {
  double by_frequency = 0.0;  ///< Re Σ conj(J) e, J of ln ω_n
  double by_damping = 0.0;    ///< of ln ζ_n
  double by_contact = 0.0;    ///< of x_c, through this mode
  double by_residue = 0.0;    ///< of B, through its residue
};
/// Adds the sums of one block, kSlopeSums of kSumLanes numbers a mode; no column is formed.
void add_mode_slopes(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                     const LikelihoodBlock& block, bool decays, const double* residual,
                     double* sums);
void collect_mode_slopes(const double* sums, std::span<const LikelihoodMode> modes,
                         const ColumnTask& task, std::span<ModeSlopes> slopes);

}  // namespace modcal
