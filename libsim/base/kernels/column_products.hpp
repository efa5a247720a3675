// Products of the columns of tall matrices, a block of rows at a time, kColumnLength apart: Gram
// matrices and combinations of columns. Instruction set chosen at run time.
#pragma once

#include <cstddef>

namespace modcal {

/// Numbers from one column of a block to the next: 256 bins, their real parts, then their imaginary
/// ones. Fixed by: layout of all blocks of columns, which kernels are compiled for.
inline constexpr std::size_t kColumnLength = 512;

/// Columns in a tile: arrays of columns are padded to a multiple of it.
/// Fixed by: columns that AddTile() and SubtractFromTile() are written for.
inline constexpr std::size_t kColumnTile = 4;
constexpr std::size_t tiled(std::size_t count) {
  return (count + kColumnTile - 1) / kColumnTile * kColumnTile;
}

/// out[i·stride + j] += Σ a_i b_j over the first `length` numbers of columns, a multiple of
/// kVectorPadding; both counts are multiples of kColumnTile. lower: only j ≤ i rounded up to tiles
/// is needed.
void add_products(const double* a, std::size_t a_count, const double* b, std::size_t b_count,
                  bool lower, double* out, std::size_t stride, std::size_t length = kColumnLength);

/// to_i −= Σ_j from_j factors[j·to_count + i] in the same numbers of columns, rounded up to
/// 2 kVectorPadding; to_count is a multiple of kColumnTile.
void subtract_columns(const double* from, std::size_t from_count, const double* factors,
                      std::size_t to_count, double* to, std::size_t length = kColumnLength);

/// column[k] *= by[k mod kColumnLength/2] for `count` columns.
void scale_columns(const double* by, std::size_t count, double* columns);

}  // namespace modcal
