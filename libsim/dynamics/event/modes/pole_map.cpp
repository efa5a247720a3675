#include "libsim/dynamics/event/modes/closed_loop.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/event/modes/pole_map.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::event::HWY_NAMESPACE {
using namespace modcal::HWY_NAMESPACE;

// kVectors blocks of outputs side by side.
template <std::size_t kVectors>
HWY_INLINE void ApplyBlock(const PoleMap& map, std::size_t inputs, const double* a, const double* b,
                           std::size_t first, PlanarVector& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Rows matrix(map.matrix);
  ComplexVector of_a[kVectors], of_b[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    of_a[v] = of_b[v] = {hn::Zero(d), hn::Zero(d)};
  }
  for (std::size_t n = 0; n < inputs; ++n) {
    const auto a_n = hn::Set(d, a[n]);
    const auto b_n = hn::Set(d, b[n]);
    for (std::size_t v = 0; v < kVectors; ++v) {
      const auto re = matrix.Re(n, first + v * lanes);
      const auto im = matrix.Im(n, first + v * lanes);
      of_a[v] = {hn::MulAdd(a_n, re, of_a[v].re), hn::MulAdd(a_n, im, of_a[v].im)};
      of_b[v] = {hn::MulAdd(b_n, re, of_b[v].re), hn::MulAdd(b_n, im, of_b[v].im)};
    }
  }
  const Source p(map.p), q(map.q);
  const Target to(out);
  for (std::size_t v = 0; v < kVectors; ++v) {
    const std::size_t i = first + v * lanes;
    const ComplexVector left = Times(p[i], of_a[v]);
    const ComplexVector right = Times(q[i], of_b[v]);
    to.Set(i, {hn::Add(left.re, right.re), hn::Add(left.im, right.im)});
  }
}

// 1/z for the product z of two numbers.
HWY_INLINE ComplexVector InverseOfProduct(ComplexVector x, ComplexVector y) {
  const ComplexVector z = Times(x, y);
  const Vector square = Power(z);
  const Vector inverse = hn::Div(hn::Set(Tag(), 1.0), square);
  return {hn::Mul(z.re, inverse), hn::Neg(hn::Mul(z.im, inverse))};
}

// A block of one vector of roots from all poles (kTowardsRoots), or the other way round.
template <bool kTowardsRoots>
HWY_INLINE void ComputeBlock(const PoleMap& map, std::size_t inputs, const double* a,
                             const double* b, std::size_t first, PlanarVector& out) {
  const Tag d;
  const Source poles(map.pole), anchors(map.anchor), offsets(map.offset);
  const auto all = [&d](const double* value) { return hn::Set(d, *value); };
  ComplexVector of_a = {hn::Zero(d), hn::Zero(d)}, of_b = of_a;
  for (std::size_t n = 0; n < inputs; ++n) {
    ComplexVector pole, anchor, offset;
    if constexpr (kTowardsRoots) {
      pole = {all(poles.re + n), all(poles.im + n)};
      anchor = anchors[first];
      offset = offsets[first];
    } else {
      pole = poles[first];
      anchor = {all(anchors.re + n), all(anchors.im + n)};
      offset = {all(offsets.re + n), all(offsets.im + n)};
    }
    // The anchor is one of the poles: the difference is exact, and the offset keeps its digits.
    const ComplexVector from = {hn::Add(hn::Sub(anchor.re, pole.re), offset.re),
                                hn::Add(hn::Sub(anchor.im, pole.im), offset.im)};
    ComplexVector mirrored = {from.re, hn::Add(hn::Add(anchor.im, pole.im), offset.im)};
    if constexpr (!kTowardsRoots) mirrored.re = hn::Neg(mirrored.re);
    ComplexVector inverse = InverseOfProduct(from, mirrored);
    if constexpr (!kTowardsRoots) inverse = {hn::Neg(inverse.re), hn::Neg(inverse.im)};
    of_a = {hn::MulAdd(all(a + n), inverse.re, of_a.re),
            hn::MulAdd(all(a + n), inverse.im, of_a.im)};
    of_b = {hn::MulAdd(all(b + n), inverse.re, of_b.re),
            hn::MulAdd(all(b + n), inverse.im, of_b.im)};
  }
  const Source p(map.p), q(map.q);
  const ComplexVector left = Times(p[first], of_a);
  const ComplexVector right = Times(q[first], of_b);
  Target(out).Set(first, {hn::Add(left.re, right.re), hn::Add(left.im, right.im)});
}

void Apply(const PoleMap& map, std::size_t inputs, const PlanarVector& in, double* a, double* b,
           PlanarVector& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Source source(in), of_a(map.a), of_b(map.b);
  for (std::size_t i = 0; i < in.size(); i += lanes) {
    const ComplexVector z = source[i];
    hn::Store(Times(of_a[i], z).re, d, a + i);
    hn::Store(Times(of_b[i], z).re, d, b + i);
  }
  std::size_t i = 0;
  if (map.matrix.count == 0) {
    for (; i < out.size(); i += lanes) {
      if (map.towards_roots) {
        ComputeBlock<true>(map, inputs, a, b, i, out);
      } else {
        ComputeBlock<false>(map, inputs, a, b, i, out);
      }
    }
    return;
  }
  for (; i + 3 * lanes <= out.size(); i += 3 * lanes) ApplyBlock<3>(map, inputs, a, b, i, out);
  for (; i < out.size(); i += lanes) ApplyBlock<1>(map, inputs, a, b, i, out);
}

}  // namespace modcal::event::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal::event {
HWY_EXPORT(Apply);

void apply(PoleMap& map, std::size_t inputs, const PlanarVector& in, PlanarVector& out) {
  HWY_DYNAMIC_DISPATCH(Apply)(map, inputs, in, map.scratch_a.data(), map.scratch_b.data(), out);
}
}  // namespace modcal::event
#endif
