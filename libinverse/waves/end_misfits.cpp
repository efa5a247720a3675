#include "libinverse/waves/end_misfits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/waves/end_misfits.cpp"
// Highway asks for this order.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// kL in n √(1 + B n²) = f/f₀, k = nπ/L, to 1e-9 at B = 1e-2 and n = 12.
HWY_INLINE Vector WaveNumber(Vector frequency, double fundamental, double inharmonicity) {
  const Vector one = hn::Set(Tag(), 1.0);
  const Vector ratio = hn::Div(frequency, hn::Set(Tag(), fundamental));
  const Vector b = hn::Mul(hn::Set(Tag(), 4.0 * inharmonicity), hn::Mul(ratio, ratio));
  const Vector shrink = hn::Div(hn::Set(Tag(), 2.0), hn::Add(one, hn::Sqrt(hn::Add(one, b))));
  return hn::Mul(hn::Set(Tag(), std::numbers::pi), hn::Mul(ratio, hn::Sqrt(shrink)));
}

HWY_INLINE ComplexVector Turn(Vector angle) {
  return {hn::Cos(Tag(), angle), hn::Sin(Tag(), angle)};
}

// 1 + |e|²/v of e = a R₁ ∓ b R₂ times those before.
HWY_INLINE void MultiplyMisfits(const EndPowers& bins, std::size_t k, Vector a, Vector b, bool both,
                                double* products) {
  const auto load = [k](const AlignedVector& of) { return hn::Load(Tag(), of.data() + k); };
  const Vector one = hn::Set(Tag(), 1.0), zero = hn::Zero(Tag());
  const Vector aa = hn::Mul(a, a), bb = hn::Mul(b, b);
  const Vector power = hn::MulAdd(aa, load(bins.left), hn::Mul(bb, load(bins.right)));
  const Vector allowed =
      hn::MulAdd(aa, load(bins.left_allowed), hn::Mul(bb, load(bins.right_allowed)));
  const Vector cross = hn::Mul(hn::Mul(a, b), load(bins.product));
  const auto counts = hn::Gt(allowed, zero);
  const Vector inverse = hn::Div(one, hn::IfThenElse(counts, allowed, one));
  const auto multiply = [&](Vector error, double* product) {
    const Vector factor = hn::MulAdd(hn::Max(error, zero), inverse, one);
    const Vector before = hn::Load(Tag(), product);
    hn::Store(hn::IfThenElse(counts, hn::Mul(before, factor), before), Tag(), product);
  };
  multiply(hn::Sub(power, cross), products);
  if (both) multiply(hn::Add(power, cross), products + kVectorPadding);
}

HWY_INLINE void TakeLogarithms(std::span<StringMisfits> sums, double* products) {
  for (StringMisfits& of_string : sums) {
    for (double& sum : of_string) {
      for (std::size_t lane = 0; lane < kVectorPadding; ++lane) {
        if (products[lane] != 1.0) sum += std::log(products[lane]);
        products[lane] = 1.0;
      }
      products += kVectorPadding;
    }
  }
}

void SumMisfits(const EndPowers& bins, const StringRow& row, bool string_alone,
                std::span<StringMisfits> sums) {
  AlignedVector products(sums.size() * 4 * kVectorPadding, 1.0);
  const Vector contact = hn::Set(Tag(), row.contact), step = hn::Set(Tag(), row.step);
  std::size_t factors = 0;
  for (std::size_t k = 0; k < bins.frequency.size(); k += hn::Lanes(Tag())) {
    const Vector wave =
        WaveNumber(hn::Load(Tag(), bins.frequency.data() + k), row.fundamental, row.inharmonicity);
    const ComplexVector whole = Turn(wave), turn = Turn(hn::Mul(wave, step));
    ComplexVector at = Turn(hn::Mul(wave, contact));  // exp(ikx_c)
    double* product = products.data();
    for (std::size_t i = 0; i < sums.size(); ++i, product += 4 * kVectorPadding) {
      // sin k(L − x_c)
      const Vector right = hn::NegMulAdd(whole.re, at.im, hn::Mul(whole.im, at.re));
      MultiplyMisfits(bins, k, at.im, right, !string_alone, product);
      if (!string_alone) {
        MultiplyMisfits(bins, k, right, at.im, true, product + 2 * kVectorPadding);
      }
      at = Times(at, turn);
    }
    // 1e9 to the power of 32 is in range.
    if (++factors % 32 == 0) TakeLogarithms(sums, products.data());
  }
  TakeLogarithms(sums, products.data());
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(SumMisfits);

void sum_misfits(const EndPowers& bins, const StringRow& row, bool string_alone,
                 std::span<StringMisfits> sums) {
  std::fill(sums.begin(), sums.end(), StringMisfits{});
  HWY_DYNAMIC_DISPATCH(SumMisfits)(bins, row, string_alone, sums);
}
}  // namespace modcal
#endif
