// What the relation between the ends of a string leaves, over time.
#pragma once

#include "libinverse/waves/end_relation.hpp"

namespace modcal {

/// sin kx_c and sin k(L − x_c) at a frequency.
struct EndFactors {
  double left, right;
};
EndFactors end_factors(double frequency, const StatedString& string);

/// Fills what `fit` says of the power that R₁ sin kx_c − R₂ sin k(L − x_c) has below 10 f₀, as a
/// whole and period by period, for the string found. A disturbance is one of every x_c about the
/// one stated.
void judge_residual(const EndRecord& record, const StatedString& found, double stated_contact,
                    EndRelationFit& fit);

}  // namespace modcal
