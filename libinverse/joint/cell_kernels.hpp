// Loops over the cells of the curve of evidence, compiled for every instruction set (Highway).
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace modcal {

/// Adds components of two degrees of freedom {2, reduced, solution, 0} to the two of `cells` cells
/// nearest to log₂ g (2e-5 near), of which an octave has `per_octave` from `lowest` on; even and
/// odd components to a set of their own, one behind the other. What lies beyond counts as the first
/// or the last cell. Returns Σ reduced of those with g = 0, which go nowhere.
double spread_pairs(std::span<const double> g, std::span<const double> reduced,
                    std::span<const double> solution, double lowest, double per_octave,
                    std::span<std::array<double, 4>> sets);

/// Columns of a table: of cells m, m u and m |x|², of values log(1 + ratio), kept and lost share.
struct CellColumns {
  const double* first = nullptr;
  const double* second = nullptr;
  const double* third = nullptr;
};

/// Cells come in whole blocks, for every width of vectors.
inline constexpr std::size_t kCellBlock = 8;

/// Σ log m − kept u, Σ lost² u, Σ kept² x, Σ kept m over `count` cells, a multiple of kCellBlock.
void sum_cells(const CellColumns& cells, const CellColumns& values, std::size_t count,
               std::span<double, 4> sums);

}  // namespace modcal
