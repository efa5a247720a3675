// Constants that were chosen, not derived.
#pragma once

#include <cstddef>

namespace modcal {

/// Chebyshev nodes that stand for the components of a band of singular values, and the ratio of the
/// largest to the smallest of a band.
/// Source: not derived; sums over components of polynomials up to degree 11 are exact.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kFilterNodes = 12;
constexpr double kFilterBandRatio = 1.5;

}  // namespace modcal
