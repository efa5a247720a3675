// Polynomial through measured damping ratios.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace modcal {

/// ζ_n ≈ Σ_j c_j n^j.
struct DampingFit {
  std::vector<double> coefficients;  ///< c_0, c_1, … [1], as PolynomialDamping takes them
  double rms_residual = std::numeric_limits<double>::quiet_NaN();  ///< [1]

  double ratio(std::size_t n) const;
};

/// Least-squares polynomial of the mode number through damping ratios of some modes, to extrapolate
/// them to all modes (Debut, Delaune and Antunes, 2010, section 7.2: degree 2), by QR.
/// mode_numbers: n ≥ 1, distinct; ratios: as many, finite. Throws InvalidInput for fewer than
/// degree + 1 modes, and for a repeated mode. The polynomial may leave [0, 1) where it
/// extrapolates: DampingLaw::ratios() refuses such a mode by name.
DampingFit fit_damping(std::span<const std::size_t> mode_numbers, std::span<const double> ratios,
                       std::size_t degree = 2);

}  // namespace modcal
