#include "libsim/dynamics/event/modal_kernels.hpp"

#include <cassert>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/event/modal_kernels.cpp"
// Highway asks for this order.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace modcal::event::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// At most 8 lanes, the padding of every table.
using Tag = hn::CappedTag<double, kVectorPadding>;
using Vec = hn::Vec<Tag>;

HWY_INLINE double Total(Vec v) { return hn::GetLane(hn::SumOfLanes(Tag(), v)); }

struct ComplexVec {
  Vec re, im;
};

HWY_INLINE ComplexVec LoadComplex(const double* re, const double* im) {
  return {hn::Load(Tag(), re), hn::Load(Tag(), im)};
}

HWY_INLINE ComplexVec Times(ComplexVec a, ComplexVec b) {
  return {hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re)),
          hn::MulAdd(a.re, b.im, hn::Mul(a.im, b.re))};
}

template <std::size_t kRows>
HWY_INLINE SumAndRate AdvanceSeen(const PlanarVector& factor, const PlanarVector& pole,
                                  const PlanarVector& state, const PlanarRows& rows, double* seen,
                                  PlanarVector& out) {
  const Tag d;
  Vec sum = hn::Zero(d), rate = hn::Zero(d);
  Vec row[kRows + 1];
  for (std::size_t r = 0; r < kRows; ++r) row[r] = hn::Zero(d);
  for (std::size_t i = 0; i < state.size(); i += hn::Lanes(d)) {
    const ComplexVec next =
        Times(LoadComplex(&factor.re[i], &factor.im[i]), LoadComplex(&state.re[i], &state.im[i]));
    hn::Store(next.re, d, &out.re[i]);
    hn::Store(next.im, d, &out.im[i]);
    sum = hn::Add(sum, next.re);
    rate = hn::MulAdd(hn::Load(d, &pole.re[i]), next.re, rate);
    rate = hn::NegMulAdd(hn::Load(d, &pole.im[i]), next.im, rate);
    for (std::size_t r = 0; r < kRows; ++r) {
      row[r] = hn::MulAdd(hn::Load(d, rows.re(r) + i), next.re, row[r]);
      row[r] = hn::NegMulAdd(hn::Load(d, rows.im(r) + i), next.im, row[r]);
    }
  }
  for (std::size_t r = 0; r < kRows; ++r) seen[r] = Total(row[r]);
  return {Total(sum), Total(rate)};
}

SumAndRate Advance(const PlanarVector& factor, const PlanarVector& pole, const PlanarVector& state,
                   const PlanarRows& rows, std::span<double> seen, PlanarVector& out) {
  switch (seen.size()) {
    case 1:
      return AdvanceSeen<1>(factor, pole, state, rows, seen.data(), out);
    case 3:
      return AdvanceSeen<3>(factor, pole, state, rows, seen.data(), out);
    default:
      assert(seen.empty());
      return AdvanceSeen<0>(factor, pole, state, rows, nullptr, out);
  }
}

SumAndRate AdvanceBy(double time, const PlanarVector& pole, const PlanarVector& state,
                     PlanarVector& out) {
  const Tag d;
  const auto t = hn::Set(d, time);
  Vec sum = hn::Zero(d), rate = hn::Zero(d);
  for (std::size_t i = 0; i < state.size(); i += hn::Lanes(d)) {
    const ComplexVec mu = LoadComplex(&pole.re[i], &pole.im[i]);
    const auto modulus = hn::Exp(d, hn::Mul(mu.re, t));
    const auto phase = hn::Mul(mu.im, t);
    const ComplexVec factor = {hn::Mul(modulus, hn::Cos(d, phase)),
                               hn::Mul(modulus, hn::Sin(d, phase))};
    const ComplexVec next = Times(factor, LoadComplex(&state.re[i], &state.im[i]));
    hn::Store(next.re, d, &out.re[i]);
    hn::Store(next.im, d, &out.im[i]);
    sum = hn::Add(sum, next.re);
    rate = hn::MulAdd(mu.re, next.re, rate);
    rate = hn::NegMulAdd(mu.im, next.im, rate);
  }
  return {Total(sum), Total(rate)};
}

// kRows sums side by side: as many chains as the latency of a multiply-add needs.
template <std::size_t kRows>
HWY_INLINE void ProductsOfRows(const PlanarRows& rows, std::size_t first, const PlanarVector& state,
                               double* out) {
  const Tag d;
  Vec sum[kRows];
  for (std::size_t r = 0; r < kRows; ++r) sum[r] = hn::Zero(d);
  for (std::size_t i = 0; i < state.size(); i += hn::Lanes(d)) {
    const ComplexVec z = LoadComplex(&state.re[i], &state.im[i]);
    for (std::size_t r = 0; r < kRows; ++r) {
      sum[r] = hn::MulAdd(hn::Load(d, rows.re(first + r) + i), z.re, sum[r]);
      sum[r] = hn::NegMulAdd(hn::Load(d, rows.im(first + r) + i), z.im, sum[r]);
    }
  }
  for (std::size_t r = 0; r < kRows; ++r) out[r] = Total(sum[r]);
}

void RealProducts(const PlanarRows& rows, const PlanarVector& state, std::span<double> out) {
  std::size_t r = 0;
  for (; r + 8 <= out.size(); r += 8) ProductsOfRows<8>(rows, r, state, &out[r]);
  for (; r + 4 <= out.size(); r += 4) ProductsOfRows<4>(rows, r, state, &out[r]);
  for (; r + 2 <= out.size(); r += 2) ProductsOfRows<2>(rows, r, state, &out[r]);
  if (r < out.size()) ProductsOfRows<1>(rows, r, state, &out[r]);
}

double WeightedSize(const AlignedVector& weight, const PlanarVector& state) {
  const Tag d;
  Vec sum = hn::Zero(d);
  for (std::size_t i = 0; i < state.size(); i += hn::Lanes(d)) {
    const ComplexVec z = LoadComplex(&state.re[i], &state.im[i]);
    sum = hn::MulAdd(hn::Load(d, &weight[i]), hn::Add(hn::Abs(z.re), hn::Abs(z.im)), sum);
  }
  return Total(sum);
}

template <std::size_t kForces>
HWY_INLINE void AdvanceDrivenBy(const PlanarVector& factor, const PlanarRows& response,
                                const double* forces, PlanarVector& state) {
  const Tag d;
  for (std::size_t i = 0; i < state.size(); i += hn::Lanes(d)) {
    ComplexVec z =
        Times(LoadComplex(&factor.re[i], &factor.im[i]), LoadComplex(&state.re[i], &state.im[i]));
    for (std::size_t j = 0; j < kForces; ++j) {
      const auto force = hn::Set(d, forces[j]);
      z.re = hn::MulAdd(hn::Load(d, response.re(j) + i), force, z.re);
      z.im = hn::MulAdd(hn::Load(d, response.im(j) + i), force, z.im);
    }
    hn::Store(z.re, d, &state.re[i]);
    hn::Store(z.im, d, &state.im[i]);
  }
}

void AdvanceDriven(const PlanarVector& factor, const PlanarRows& response,
                   std::span<const double> forces, PlanarVector& state) {
  switch (forces.size()) {
    case 2:
      return AdvanceDrivenBy<2>(factor, response, forces.data(), state);
    case 3:
      return AdvanceDrivenBy<3>(factor, response, forces.data(), state);
    case 4:
      return AdvanceDrivenBy<4>(factor, response, forces.data(), state);
    default:
      return AdvanceDrivenBy<5>(factor, response, forces.data(), state);
  }
}

void AdvanceDrivenFor(double time, double largest, const PlanarVector& pole,
                      const AlignedVector& drive, std::span<const double> weights,
                      PlanarVector& state) {
  constexpr int kMostTerms = 32;
  const Tag d;
  const std::size_t order = weights.size();
  // coefficient[p] = 1/(p + order)!, as many as the largest |x| needs for rounding.
  double coefficient[kMostTerms];
  double value = 1.0;
  for (std::size_t k = 2; k <= order; ++k) value /= static_cast<double>(k);
  int terms = 1;
  coefficient[0] = value;
  for (double size = 1.0; terms < kMostTerms && size > 1e-18; ++terms) {
    const double divisor = static_cast<double>(static_cast<std::size_t>(terms) + order);
    coefficient[terms] = coefficient[terms - 1] / divisor;
    size *= largest / divisor;
  }
  double inverse_factorial[8] = {1.0};
  for (std::size_t k = 1; k < order; ++k) {
    inverse_factorial[k] = inverse_factorial[k - 1] / static_cast<double>(k);
  }
  const auto t = hn::Set(d, time);
  for (std::size_t i = 0; i < state.size(); i += hn::Lanes(d)) {
    const ComplexVec x = {hn::Mul(hn::Load(d, &pole.re[i]), t),
                          hn::Mul(hn::Load(d, &pole.im[i]), t)};
    ComplexVec phi = {hn::Set(d, coefficient[terms - 1]), hn::Zero(d)};
    for (int p = terms - 1; p-- > 0;) {
      phi = Times(phi, x);
      phi.re = hn::Add(phi.re, hn::Set(d, coefficient[p]));
    }
    ComplexVec forced = {hn::Zero(d), hn::Zero(d)};
    for (std::size_t k = order; k-- > 0;) {  // phi is φ_{k+1} here
      const auto weight = hn::Set(d, weights[k]);
      forced.re = hn::MulAdd(weight, phi.re, forced.re);
      forced.im = hn::MulAdd(weight, phi.im, forced.im);
      phi = Times(phi, x);
      phi.re = hn::Add(phi.re, hn::Set(d, inverse_factorial[k]));
    }
    const auto gain = hn::Load(d, &drive[i]);
    const ComplexVec free = Times(phi, LoadComplex(&state.re[i], &state.im[i]));
    hn::Store(hn::MulAdd(gain, forced.re, free.re), d, &state.re[i]);
    hn::Store(hn::MulAdd(gain, forced.im, free.im), d, &state.im[i]);
  }
}

// kVectors blocks of outputs side by side.
template <std::size_t kVectors>
HWY_INLINE void ApplyBlock(const PoleMap& map, std::size_t inputs, const double* a, const double* b,
                           std::size_t first, PlanarVector& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  Vec a_re[kVectors], a_im[kVectors], b_re[kVectors], b_im[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    a_re[v] = a_im[v] = b_re[v] = b_im[v] = hn::Zero(d);
  }
  for (std::size_t n = 0; n < inputs; ++n) {
    const auto a_n = hn::Set(d, a[n]);
    const auto b_n = hn::Set(d, b[n]);
    for (std::size_t v = 0; v < kVectors; ++v) {
      const std::size_t i = first + v * lanes;
      const auto re = hn::Load(d, map.matrix.re(n) + i);
      const auto im = hn::Load(d, map.matrix.im(n) + i);
      a_re[v] = hn::MulAdd(a_n, re, a_re[v]);
      a_im[v] = hn::MulAdd(a_n, im, a_im[v]);
      b_re[v] = hn::MulAdd(b_n, re, b_re[v]);
      b_im[v] = hn::MulAdd(b_n, im, b_im[v]);
    }
  }
  for (std::size_t v = 0; v < kVectors; ++v) {
    const std::size_t i = first + v * lanes;
    const ComplexVec p = Times(LoadComplex(&map.p.re[i], &map.p.im[i]), {a_re[v], a_im[v]});
    const ComplexVec q = Times(LoadComplex(&map.q.re[i], &map.q.im[i]), {b_re[v], b_im[v]});
    hn::Store(hn::Add(p.re, q.re), d, &out.re[i]);
    hn::Store(hn::Add(p.im, q.im), d, &out.im[i]);
  }
}

void Apply(const PoleMap& map, std::size_t inputs, const PlanarVector& in, double* a, double* b,
           PlanarVector& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < in.size(); i += lanes) {
    const ComplexVec z = LoadComplex(&in.re[i], &in.im[i]);
    hn::Store(Times(LoadComplex(&map.a.re[i], &map.a.im[i]), z).re, d, a + i);
    hn::Store(Times(LoadComplex(&map.b.re[i], &map.b.im[i]), z).re, d, b + i);
  }
  std::size_t i = 0;
  for (; i + 3 * lanes <= out.size(); i += 3 * lanes) ApplyBlock<3>(map, inputs, a, b, i, out);
  for (; i < out.size(); i += lanes) ApplyBlock<1>(map, inputs, a, b, i, out);
}

}  // namespace modcal::event::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal::event {
HWY_EXPORT(Advance);
HWY_EXPORT(AdvanceBy);
HWY_EXPORT(RealProducts);
HWY_EXPORT(WeightedSize);
HWY_EXPORT(AdvanceDriven);
HWY_EXPORT(AdvanceDrivenFor);
HWY_EXPORT(Apply);

SumAndRate advance(const PlanarVector& factor, const PlanarVector& pole, const PlanarVector& state,
                   PlanarVector& out, const PlanarRows& rows, std::span<double> seen) {
  return HWY_DYNAMIC_DISPATCH(Advance)(factor, pole, state, rows, seen, out);
}

SumAndRate advance_by(double time, const PlanarVector& pole, const PlanarVector& state,
                      PlanarVector& out) {
  return HWY_DYNAMIC_DISPATCH(AdvanceBy)(time, pole, state, out);
}

void real_products(const PlanarRows& rows, const PlanarVector& state, std::span<double> out) {
  HWY_DYNAMIC_DISPATCH(RealProducts)(rows, state, out);
}

double weighted_size(const AlignedVector& weight, const PlanarVector& state) {
  return HWY_DYNAMIC_DISPATCH(WeightedSize)(weight, state);
}

void advance_driven(const PlanarVector& factor, const PlanarRows& response,
                    std::span<const double> forces, PlanarVector& state) {
  HWY_DYNAMIC_DISPATCH(AdvanceDriven)(factor, response, forces, state);
}

void advance_driven_by(double time, double largest, const PlanarVector& pole,
                       const AlignedVector& drive, std::span<const double> weights,
                       PlanarVector& state) {
  HWY_DYNAMIC_DISPATCH(AdvanceDrivenFor)(time, largest, pole, drive, weights, state);
}

void apply(PoleMap& map, std::size_t inputs, const PlanarVector& in, PlanarVector& out) {
  HWY_DYNAMIC_DISPATCH(Apply)(map, inputs, in, map.scratch_a.data(), map.scratch_b.data(), out);
}
}  // namespace modcal::event
#endif
