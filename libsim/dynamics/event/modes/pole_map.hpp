// The map between the coordinates of the free and of the held string.
#pragma once

#include <cstddef>

#include "libsim/dynamics/event/modes/modal_kernels.hpp"

namespace modcal::event {

/// Real-linear map between complex vectors whose matrix is a product of poles' differences:
/// out_j = p_j Σ_n A_n M_nj + q_j Σ_n B_n M_nj with A = Re(a ∘ in), B = Re(b ∘ in).
/// Where the matrix would not fit into the caches (or the memory) it is computed entry by entry
/// from the poles λ of the open loop and the roots μ = anchor + offset of the closed one, which
/// costs no more than reading it: 1/((μ − λ)(μ − λ̄)) towards the roots, 1/((λ − μ)(λ − μ̄)) towards
/// the poles.
struct PoleMap {
  PlanarVector a, b;
  PlanarRows matrix;  ///< one row an input; empty: computed
  PlanarVector p, q;
  bool towards_roots = false;
  PlanarVector pole, anchor, offset;   ///< of a computed matrix
  AlignedVector scratch_a, scratch_b;  ///< A and B of the running call
};

/// out = the map of the first `inputs` numbers of `in`; `out` is as long as `p`.
void apply(PoleMap& map, std::size_t inputs, const PlanarVector& in, PlanarVector& out);

}  // namespace modcal::event
