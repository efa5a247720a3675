// Products of the columns of one block of bins, kColumnLength numbers each.
#pragma once

#include <cstddef>

namespace modcal {

/// Columns in a tile: arrays of columns are padded to a multiple of it.
inline constexpr std::size_t kColumnTile = 4;
constexpr std::size_t tiled(std::size_t count) {
  return (count + kColumnTile - 1) / kColumnTile * kColumnTile;
}

/// out[i·stride + j] += Σ a_i b_j; both counts are multiples of kColumnTile. lower: only j ≤ i
/// rounded up to tiles is needed.
void add_products(const double* a, std::size_t a_count, const double* b, std::size_t b_count,
                  bool lower, double* out, std::size_t stride);

/// to_i −= Σ_j from_j factors[j·to_count + i]; to_count is a multiple of kColumnTile.
void subtract_columns(const double* from, std::size_t from_count, const double* factors,
                      std::size_t to_count, double* to);

/// column[k] *= by[k mod kBlock] for `count` columns.
void scale_columns(const double* by, std::size_t count, double* columns);

}  // namespace modcal
