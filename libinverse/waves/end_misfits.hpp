// Kernel of the search for a string: by how much the relation between its ends fails. Instruction
// set chosen at run time.
#pragma once

#include <array>
#include <span>

#include "libsim/base/aligned_vector.hpp"

namespace modcal {

/// Sum or mean of ln(1 + |e|²/v) over the bins of one string, as stated, with one sign turned, and both
/// again with the ends exchanged.
using StringMisfits = std::array<double, 4>;

/// Powers of both ends at some bins, in whole vectors; a frequency of 0 does not count.
struct EndPowers {
  AlignedVector frequency;                    ///< [Hz]
  AlignedVector left, right, product;         ///< |R₁|², |R₂|², 2 Re R₁ R₂*
  AlignedVector left_allowed, right_allowed;  ///< what v has of them for a² and b²
};

/// Strings that differ in their contacts, x_c/L = contact + i·step.
struct StringRow {
  double fundamental = 0.0, inharmonicity = 0.0;
  double contact = 0.0, step = 0.0;
};

/// Sums over the bins of every string of the row; 1 + |e|²/v must not exceed 1e9. string_alone: the
/// first of the four alone, others 0.
void sum_misfits(const EndPowers& bins, const StringRow& row, bool string_alone,
                 std::span<StringMisfits> sums);

}  // namespace modcal
