// Complex numbers and padded vectors in the lanes of the machine, for the kernels. Compiled once
// for every instruction set: include it after <hwy/highway.h>, outside any namespace.
#if defined(MODCAL_PLANAR_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODCAL_PLANAR_LANES_INL
#undef MODCAL_PLANAR_LANES_INL
#else
#define MODCAL_PLANAR_LANES_INL
#endif

#include "libsim/base/aligned_vector.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 8 lanes, the padding of every table.
using Tag = hn::CappedTag<double, kVectorPadding>;
using Vector = hn::Vec<Tag>;

// A complex number in every lane.
template <class V>
struct ComplexOf {
  V re, im;
};
using ComplexVector = ComplexOf<Vector>;

template <class V>
HWY_INLINE ComplexOf<V> Times(ComplexOf<V> a, ComplexOf<V> b) {
  return {hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re)),
          hn::MulAdd(a.re, b.im, hn::Mul(a.im, b.re))};
}
template <class V>
HWY_INLINE V Power(ComplexOf<V> z) {
  return hn::MulAdd(z.re, z.re, hn::Mul(z.im, z.im));
}

HWY_INLINE double Total(Vector v) { return hn::GetLane(hn::SumOfLanes(Tag(), v)); }

// The totals of four vectors at once: a third of the shuffles of one after the other.
HWY_INLINE void FourTotals(Vector a, Vector b, Vector c, Vector d, double* out) {
#if HWY_TARGET != HWY_SCALAR
  const Tag tag;
  constexpr std::size_t kLanes = hn::MaxLanes(tag);
  if constexpr (kLanes == 4 || kLanes == 8) {
    // Blocks of two lanes (a b) and (c d), then both in one vector.
    const Vector ab = hn::Add(hn::InterleaveLower(tag, a, b), hn::InterleaveUpper(tag, a, b));
    const Vector cd = hn::Add(hn::InterleaveLower(tag, c, d), hn::InterleaveUpper(tag, c, d));
    Vector sum = hn::Add(hn::ConcatUpperLower(tag, cd, ab), hn::ConcatLowerUpper(tag, cd, ab));
    if constexpr (kLanes == 8) sum = hn::Add(sum, hn::SwapAdjacentBlocks(sum));
    HWY_ALIGN double lanes[kLanes];
    hn::Store(sum, tag, lanes);
    out[0] = lanes[0];
    out[1] = lanes[1];
    out[2] = lanes[kLanes / 2];
    out[3] = lanes[kLanes / 2 + 1];
    return;
  }
#endif
  out[0] = Total(a);
  out[1] = Total(b);
  out[2] = Total(c);
  out[3] = Total(d);
}

// The arrays of a planar vector, read once: a store through a pointer could otherwise change the
// vector's own pointers, and every iteration would load them again.
struct Source {
  const double* re;
  const double* im;
  explicit Source(const PlanarVector& v) : re(v.re.data()), im(v.im.data()) {}
  HWY_INLINE ComplexVector operator[](std::size_t i) const {
    return {hn::Load(Tag(), re + i), hn::Load(Tag(), im + i)};
  }
};
struct Target {
  double* re;
  double* im;
  explicit Target(PlanarVector& v) : re(v.re.data()), im(v.im.data()) {}
  HWY_INLINE void Set(std::size_t i, ComplexVector value) const {
    hn::Store(value.re, Tag(), re + i);
    hn::Store(value.im, Tag(), im + i);
  }
};
// Row r of planar rows: re at 2 r size, im behind it.
struct Rows {
  const double* data;
  std::size_t size;
  explicit Rows(const PlanarRows& rows, std::size_t first = 0)
      : data(rows.re(first < rows.count ? first : rows.count)), size(rows.size) {}
  HWY_INLINE Vector Re(std::size_t row, std::size_t i) const {
    return hn::Load(Tag(), data + 2 * row * size + i);
  }
  HWY_INLINE Vector Im(std::size_t row, std::size_t i) const {
    return hn::Load(Tag(), data + (2 * row + 1) * size + i);
  }
};

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
