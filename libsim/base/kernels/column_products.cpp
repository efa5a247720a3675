#include "libsim/base/kernels/column_products.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/base/kernels/column_products.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

constexpr std::size_t kL = kColumnLength;

// Products of four columns with four: sixteen accumulators hide the latency of multiply-add.
HWY_INLINE void AddTile(const double* a, const double* b, double* out, std::size_t stride,
                        std::size_t length) {
  Vector s00 = hn::Zero(Tag()), s01 = s00, s02 = s00, s03 = s00, s10 = s00, s11 = s00, s12 = s00,
         s13 = s00, s20 = s00, s21 = s00, s22 = s00, s23 = s00, s30 = s00, s31 = s00, s32 = s00,
         s33 = s00;
  for (std::size_t k = 0; k < length; k += hn::Lanes(Tag())) {
    const Vector b0 = hn::Load(Tag(), b + k), b1 = hn::Load(Tag(), b + kL + k),
                 b2 = hn::Load(Tag(), b + 2 * kL + k), b3 = hn::Load(Tag(), b + 3 * kL + k);
    const Vector a0 = hn::Load(Tag(), a + k);
    s00 = hn::MulAdd(a0, b0, s00), s01 = hn::MulAdd(a0, b1, s01);
    s02 = hn::MulAdd(a0, b2, s02), s03 = hn::MulAdd(a0, b3, s03);
    const Vector a1 = hn::Load(Tag(), a + kL + k);
    s10 = hn::MulAdd(a1, b0, s10), s11 = hn::MulAdd(a1, b1, s11);
    s12 = hn::MulAdd(a1, b2, s12), s13 = hn::MulAdd(a1, b3, s13);
    const Vector a2 = hn::Load(Tag(), a + 2 * kL + k);
    s20 = hn::MulAdd(a2, b0, s20), s21 = hn::MulAdd(a2, b1, s21);
    s22 = hn::MulAdd(a2, b2, s22), s23 = hn::MulAdd(a2, b3, s23);
    const Vector a3 = hn::Load(Tag(), a + 3 * kL + k);
    s30 = hn::MulAdd(a3, b0, s30), s31 = hn::MulAdd(a3, b1, s31);
    s32 = hn::MulAdd(a3, b2, s32), s33 = hn::MulAdd(a3, b3, s33);
  }
  out[0] += Total(s00), out[1] += Total(s01), out[2] += Total(s02), out[3] += Total(s03);
  out += stride;
  out[0] += Total(s10), out[1] += Total(s11), out[2] += Total(s12), out[3] += Total(s13);
  out += stride;
  out[0] += Total(s20), out[1] += Total(s21), out[2] += Total(s22), out[3] += Total(s23);
  out += stride;
  out[0] += Total(s30), out[1] += Total(s31), out[2] += Total(s32), out[3] += Total(s33);
}

void AddProducts(const double* a, std::size_t a_count, const double* b, std::size_t b_count,
                 bool lower, double* out, std::size_t stride, std::size_t length) {
  for (std::size_t i = 0; i < a_count; i += kColumnTile) {
    for (std::size_t j = 0; j < b_count; j += kColumnTile) {
      if (lower && j > i) break;
      AddTile(a + i * kL, b + j * kL, out + i * stride + j, stride, length);
    }
  }
}

// Four columns at once over two vectors of bins each.
HWY_INLINE void SubtractFromTile(const double* from, std::size_t from_count, const double* factors,
                                 std::size_t stride, double* to, std::size_t length) {
  const std::size_t lanes = hn::Lanes(Tag());
  for (std::size_t k = 0; k < length; k += 2 * lanes) {
    double *t0 = to + k, *t1 = t0 + kL, *t2 = t1 + kL, *t3 = t2 + kL;
    Vector a0 = hn::Load(Tag(), t0), a1 = hn::Load(Tag(), t1), a2 = hn::Load(Tag(), t2),
           a3 = hn::Load(Tag(), t3), b0 = hn::Load(Tag(), t0 + lanes),
           b1 = hn::Load(Tag(), t1 + lanes), b2 = hn::Load(Tag(), t2 + lanes),
           b3 = hn::Load(Tag(), t3 + lanes);
    for (std::size_t j = 0; j < from_count; ++j) {
      const Vector x = hn::Load(Tag(), from + j * kL + k),
                   y = hn::Load(Tag(), from + j * kL + k + lanes);
      const double* row = factors + j * stride;
      const Vector f0 = hn::Set(Tag(), row[0]), f1 = hn::Set(Tag(), row[1]),
                   f2 = hn::Set(Tag(), row[2]), f3 = hn::Set(Tag(), row[3]);
      a0 = hn::NegMulAdd(x, f0, a0), b0 = hn::NegMulAdd(y, f0, b0);
      a1 = hn::NegMulAdd(x, f1, a1), b1 = hn::NegMulAdd(y, f1, b1);
      a2 = hn::NegMulAdd(x, f2, a2), b2 = hn::NegMulAdd(y, f2, b2);
      a3 = hn::NegMulAdd(x, f3, a3), b3 = hn::NegMulAdd(y, f3, b3);
    }
    hn::Store(a0, Tag(), t0), hn::Store(a1, Tag(), t1), hn::Store(a2, Tag(), t2);
    hn::Store(a3, Tag(), t3), hn::Store(b0, Tag(), t0 + lanes), hn::Store(b1, Tag(), t1 + lanes);
    hn::Store(b2, Tag(), t2 + lanes), hn::Store(b3, Tag(), t3 + lanes);
  }
}

void SubtractColumns(const double* from, std::size_t from_count, const double* factors,
                     std::size_t to_count, double* to, std::size_t length) {
  for (std::size_t i = 0; i < to_count; i += kColumnTile) {
    SubtractFromTile(from, from_count, factors + i, to_count, to + i * kL, length);
  }
}

void ScaleColumns(const double* by, std::size_t count, double* columns) {
  for (std::size_t i = 0; i < 2 * count; ++i, columns += kL / 2) {
    for (std::size_t k = 0; k < kL / 2; k += hn::Lanes(Tag())) {
      hn::Store(hn::Mul(hn::Load(Tag(), columns + k), hn::Load(Tag(), by + k)), Tag(), columns + k);
    }
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(AddProducts);
HWY_EXPORT(SubtractColumns);
HWY_EXPORT(ScaleColumns);

void add_products(const double* a, std::size_t a_count, const double* b, std::size_t b_count,
                  bool lower, double* out, std::size_t stride, std::size_t length) {
  HWY_DYNAMIC_DISPATCH(AddProducts)(a, a_count, b, b_count, lower, out, stride, length);
}

void subtract_columns(const double* from, std::size_t from_count, const double* factors,
                      std::size_t to_count, double* to, std::size_t length) {
  HWY_DYNAMIC_DISPATCH(SubtractColumns)(from, from_count, factors, to_count, to, length);
}

void scale_columns(const double* by, std::size_t count, double* columns) {
  HWY_DYNAMIC_DISPATCH(ScaleColumns)(by, count, columns);
}
}  // namespace modcal
#endif
