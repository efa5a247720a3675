// A bridge that moves, as a part of what a fit has found.
#pragma once

#include <span>
#include <vector>

#include "libcalib/identifiability/misfit_causes.hpp"
#include "libcalib/likelihood/records/whitened_record.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// A further mode of the body, or a change of the one at the same place.
void add_to_body(const ScoreTest& further, std::vector<ScoreTest>& body);

/// Takes what a bridge that moves adds, Σ_i Σ_j p_ij c_ij, from both reactions as they were
/// recorded: what is left are those of a pinned string. p_ij: the amplitudes of each of `body`;
/// c_ij: the columns at its place (bridges_at()), of `model`, the pinned string, and R_2. Up to
/// `highest` [rad/s]; beyond nothing changes.
void take_out(std::span<const ScoreTest> body, const ModelPoint& model, double highest,
              NoisyRecords& records);

/// ω_n and ζ_n of a pinned string on modes of a body at x = L: the zeros s near s_n of
///
///     1 + (T/L) (1 + 2 Σ_m s²/D_m(s)) Σ_i κ_i/(s² + 2ζ_b ω_i s + ω_i²),
///
/// D_m(s) = s² + 2ζ_m ω_m s + ω_m², κ_i the amplitudes 1/m and ω_i the places of `body`, those
/// beside included (bridges_at()), ζ_b = kBodyDamping. False, and nothing changed, where they are
/// not found: a mode of the body so near to one of the string, or so light, that they change
/// places.
bool put_on_bridge(ModalBasis& basis, std::span<const ScoreTest> body);

}  // namespace modcal
