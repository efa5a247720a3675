// e^x for x ≤ 0 without a call.
#pragma once

#include <bit>
#include <cstdint>

namespace modcal {

/// e^x for x ≤ 0 to 1.2 ulp; 1e-300 below −690, where products with it are no denormals yet, which
/// would cost a hundred times as much. NaN stays NaN. Inlined into a loop, it leaves the loop's
/// vectors in their registers, which a call to the library's would push out; and it takes the
/// instruction set of the loop.
///
/// x = k/32 ln 2 + r with |r| ≤ ln 2/64 (k falls out of an addition that rounds to whole numbers),
/// 2^(k mod 32 / 32) from a table, e^r by its Taylor polynomial of degree 6, r^7/7! = 4e-18.
inline double decaying_exp(double x) {
  constexpr double kSteps = 0x1.71547652b82fep+5, kRounding = 6755399441055744.0;  // 1.5·2⁵²
  constexpr double kStepHigh = 0x1.62e42fefp-6, kStepLow = 0x1.473de6af278edp-39;
  static constexpr double kPowers[32] = {
      0x1.0000000000000p+0, 0x1.059b0d3158574p+0, 0x1.0b5586cf9890fp+0, 0x1.11301d0125b51p+0,
      0x1.172b83c7d517bp+0, 0x1.1d4873168b9aap+0, 0x1.2387a6e756238p+0, 0x1.29e9df51fdee1p+0,
      0x1.306fe0a31b715p+0, 0x1.371a7373aa9cbp+0, 0x1.3dea64c123422p+0, 0x1.44e086061892dp+0,
      0x1.4bfdad5362a27p+0, 0x1.5342b569d4f82p+0, 0x1.5ab07dd485429p+0, 0x1.6247eb03a5585p+0,
      0x1.6a09e667f3bcdp+0, 0x1.71f75e8ec5f74p+0, 0x1.7a11473eb0187p+0, 0x1.82589994cce13p+0,
      0x1.8ace5422aa0dbp+0, 0x1.93737b0cdc5e5p+0, 0x1.9c49182a3f090p+0, 0x1.a5503b23e255dp+0,
      0x1.ae89f995ad3adp+0, 0x1.b7f76f2fb5e47p+0, 0x1.c199bdd85529cp+0, 0x1.cb720dcef9069p+0,
      0x1.d5818dcfba487p+0, 0x1.dfc97337b9b5fp+0, 0x1.ea4afa2a490dap+0, 0x1.f50765b6e4540p+0};
  x = x < -690.0 ? -690.0 : x;
  const double shifted = x * kSteps + kRounding;
  const double k = shifted - kRounding;
  const double r = (x - k * kStepHigh) - k * kStepLow;
  const auto bits = std::bit_cast<std::uint64_t>(shifted);
  const auto power = std::bit_cast<std::uint64_t>(kPowers[bits & 31]);
  const auto scale = std::bit_cast<double>(power + (bits >> 5 << 52));
  const double r2 = r * r;
  const double high = (1.0 / 24 + r * (1.0 / 120)) + r2 * (1.0 / 720);
  const double tail = r + r2 * ((1.0 / 2 + r * (1.0 / 6)) + r2 * high);
  return scale + scale * tail;
}

}  // namespace modcal
