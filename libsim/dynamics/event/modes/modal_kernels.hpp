// Vector kernels of the event-driven integrator: sums and updates over all modes. No allocation, no
// I/O; the instruction set is chosen at run time. Every vector is padded with zeros.
#pragma once

#include <array>
#include <span>

#include "libsim/base/aligned_vector.hpp"

namespace modcal::event {
/// Re Σ w and Re Σ μ w.
struct SumAndRate {
  double sum = 0.0;
  double rate = 0.0;
};

/// Eight numbers side by side.
using Octet = std::array<double, kVectorPadding>;

/// The kernels of one instruction set.
struct ModalKernels {
  /// out = factor ∘ state; returns the sums of the new state and, in `seen`, Re Σ rows[r] out of
  /// the first 0, 1 or 3 rows.
  SumAndRate (*advance)(const PlanarVector& factor, const PlanarVector& pole,
                        const PlanarVector& state, PlanarVector& out, const PlanarRows& rows,
                        std::span<double> seen);
  /// out = e^{pole·time} ∘ state for any time; |pole·time| ≤ 1e4. Returns the sums of the new
  /// state.
  SumAndRate (*advance_by)(double time, const PlanarVector& pole, const PlanarVector& state,
                           PlanarVector& out);
  /// out[r] = Re Σ_n rows[r][n] state[n].
  void (*real_products)(const PlanarRows& rows, const PlanarVector& state, std::span<double> out);
  /// Σ weight (|Re state| + |Im state|) ≥ Σ weight |state|.
  double (*weighted_size)(const AlignedVector& weight, const PlanarVector& state);
  /// state ← factor ∘ state + Σ_j forces[j] response[j].
  void (*advance_driven)(const PlanarVector& factor, const PlanarRows& response,
                         std::span<const double> forces, PlanarVector& state);
  /// state ← e^{x} ∘ state + drive ∘ Σ_k weights[k] φ_{k+1}(x), x = pole·time, |x| ≤ `largest`,
  /// φ_0 = e^x, φ_k = (φ_{k−1} − 1/(k−1)!)/x: the highest by its Taylor series, the others by the
  /// downward recursion φ_k = x φ_{k+1} + 1/k!, both stable for |x| up to about 2.
  void (*advance_driven_by)(double time, double largest, const PlanarVector& pole,
                            const AlignedVector& drive, std::span<const double> weights,
                            PlanarVector& state);
  /// out[i][k] = Σ_p table[p][k] x_i^p, k < 8, i < 4.
  void (*polynomials)(std::span<const Octet> table, const std::array<double, 4>& x,
                      std::array<Octet, 4>& out);
};

/// Those of this machine.
const ModalKernels& modal_kernels();
/// Those of the set that is allowed now, which a test may have changed.
const ModalKernels& modal_kernels_of_allowed_set();

}  // namespace modcal::event
