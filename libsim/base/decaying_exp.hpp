// e^x for x ≤ 0 without a call.
#pragma once

#include <bit>
#include <cstdint>

namespace modcal {

/// e^x for x ≤ 0 to 1 ulp; 2e-308 below −708. NaN stays NaN. Inlined into a loop, it leaves the
/// loop's vectors in their registers, which a call to the library's would push out; and it takes
/// the instruction set of the loop.
///
/// x = k ln 2 + r with |r| ≤ ln 2/2 (k falls out of an addition that rounds to whole numbers), e^r
/// by its Taylor polynomial of degree 13, r^14/14! = 4e-18.
inline double decaying_exp(double x) {
  constexpr double kLog2E = 1.4426950408889634, kRounding = 6755399441055744.0;  // 1.5·2⁵²
  constexpr double kLn2High = 6.93147180369123816490e-01, kLn2Low = 1.90821492927058770002e-10;
  x = x < -708.0 ? -708.0 : x;
  const double shifted = x * kLog2E + kRounding;
  const double k = shifted - kRounding;
  const double r = (x - k * kLn2High) - k * kLn2Low;
  const double r2 = r * r, r4 = r2 * r2;
  const double c2 = 1.0 / 2 + r * (1.0 / 6);
  const double c4 = 1.0 / 24 + r * (1.0 / 120);
  const double c6 = 1.0 / 720 + r * (1.0 / 5040);
  const double c8 = 1.0 / 40320 + r * (1.0 / 362880);
  const double c10 = 1.0 / 3628800 + r * (1.0 / 39916800);
  const double c12 = 1.0 / 479001600 + r * (1.0 / 6227020800);
  const double high = (c6 + r2 * c8) + r4 * (c10 + r2 * c12);
  const double tail = r2 * ((c2 + r2 * c4) + r4 * high);
  const auto exponent = std::bit_cast<std::uint64_t>(shifted) << 52;
  const auto scale = std::bit_cast<double>(exponent + std::bit_cast<std::uint64_t>(1.0));
  return scale * (1.0 + (r + tail));
}

}  // namespace modcal
