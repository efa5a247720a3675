// Kernels of the free decays in a record: their transforms in some bins as columns, their sum, and
// what a window makes of them. Instruction set chosen at run time.
#pragma once

#include <complex>
#include <cstddef>
#include <span>

#include "libsim/base/aligned_vector.hpp"
#include "libsim/base/kernels/column_products.hpp"

namespace modcal {

/// A mode that rings, q(t) = Re(c exp(λt)): two unknowns, Re c and Im c.
struct RingingMode {
  std::complex<double> pole;  ///< E = exp(λ/f_s)
  double left = 0.0, right = 0.0;
  std::complex<double> own;
};

/// What the columns of the modes are multiplied by, bin by bin: f = left·F_left + right·F_right,
/// and `own`, w of which is added.
struct RingingFactors {
  PlanarVector left, right;
  AlignedVector own;  ///< w

  RingingFactors() = default;
  explicit RingingFactors(std::size_t bins) : left(bins), right(bins), own(left.size()) {}
  void set(std::size_t bin, std::complex<double> f_left, std::complex<double> f_right, double w) {
    left.set(bin, f_left);
    right.set(bin, f_right);
    own[bin] = w;
  }
};

/// With U = 1/(1 − E z⁻¹), U' = 1/(1 − conj(E) z⁻¹), D(c) = (c U + conj(c) U')/2: the columns
/// f D(1) + w D(own) and f D(i) + w D(i own) of every mode in turn, kColumnLength apart, real parts
/// of all bins of `delay` before imaginary ones. delay: z⁻¹; all arrays as long as it is, a
/// multiple of kVectorPadding.
void fill_ringing_columns(std::span<const RingingMode> modes, const PlanarVector& delay,
                          const RingingFactors& factors, double* columns);

/// Adds the sums of left_n D_n(own_n) and of right_n D_n(own_n).
void add_ringing(std::span<const RingingMode> modes, const PlanarVector& delay, PlanarVector& left,
                 PlanarVector& right);

/// to[k] = Σ_m lines[|m|] from[k + lines.size() − 1 + m] for k < count, a multiple of
/// kVectorPadding.
void smear(std::span<const double> lines, const double* from, std::size_t count, double* to);

}  // namespace modcal
