#include "libinverse/structure/blind_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/structure/blind_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

HWY_INLINE ComplexVector Scaled(ComplexVector z, Vector by) {
  return {hn::Mul(z.re, by), hn::Mul(z.im, by)};
}
HWY_INLINE ComplexVector Sum(ComplexVector a, ComplexVector b) {
  return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
HWY_INLINE ComplexVector Minus(ComplexVector z) { return {hn::Neg(z.re), hn::Neg(z.im)}; }

void ShapeMode(const BlindBins& bins, const ModalPole& pole, ModeShapes& out) {
  const Tag tag;
  const Source s(bins.s), turned(bins.turned);
  const Target inverse(out.inverse), by_omega(out.by_omega), by_zeta(out.by_zeta);
  const Target low(out.low), low_omega(out.low_omega), low_zeta(out.low_zeta);
  const Target high(out.high), high_omega(out.high_omega), high_zeta(out.high_zeta);
  const Vector omega = hn::Set(tag, pole.omega), loss = hn::Set(tag, 2.0 * pole.zeta * pole.omega);
  const Vector twice = hn::Set(tag, 2.0 * pole.omega * pole.omega);
  const Vector period = hn::Set(tag, 1.0 / pole.omega), one = hn::Set(tag, 1.0);
  for (std::size_t m = 0; m < bins.padded(); m += hn::Lanes(tag)) {
    const ComplexVector at = s[m];
    const ComplexVector denominator = {
        hn::MulAdd(at.re, hn::Add(at.re, loss),
                   hn::Mul(hn::Sub(omega, at.im), hn::Add(omega, at.im))),
        hn::Mul(at.im, hn::Add(loss, hn::Add(at.re, at.re)))};
    const Vector scale = hn::Div(one, Power(denominator));
    const ComplexVector reciprocal = {hn::Mul(denominator.re, scale),
                                      hn::Neg(hn::Mul(denominator.im, scale))};
    const ComplexVector square = Minus(Times(reciprocal, reciprocal)), lost = Scaled(at, loss);
    const ComplexVector zeta = Times(lost, square);
    const ComplexVector slope = Times({hn::Add(twice, lost.re), lost.im}, square);
    inverse.Set(m, reciprocal);
    by_omega.Set(m, slope);
    by_zeta.Set(m, zeta);
    const ComplexVector q_low = Scaled(at, period), q_high = Scaled(turned[m], omega);
    const ComplexVector own_low = Times(q_low, reciprocal), own_high = Times(q_high, reciprocal);
    low.Set(m, own_low);
    high.Set(m, own_high);
    // s/ω falls and −ω/s grows with ω.
    low_omega.Set(m, Sum(Times(q_low, slope), Minus(own_low)));
    high_omega.Set(m, Sum(Times(q_high, slope), own_high));
    low_zeta.Set(m, Times(q_low, zeta));
    high_zeta.Set(m, Times(q_high, zeta));
  }
}

void ProjectColumn(const BlindBins& bins, const ColumnTerms& terms, double* column) {
  const Tag tag;
  const std::size_t sensors = bins.sensors.size(), length = bins.padded();
  double* const imaginary = column + sensors * length;
  const Source x(*terms.x), low(*terms.low), high(*terms.high);
  for (std::size_t m = 0; m < length; m += hn::Lanes(tag)) {
    ComplexVector along = {hn::Zero(tag), hn::Zero(tag)};
    for (std::size_t k = 0; k < sensors; ++k) {
      const BlindBins::Sensor& sensor = bins.sensors[k];
      const ComplexVector y = sensor.low ? low[m] : high[m];
      const Vector a = hn::Set(tag, terms.a[k]), b = hn::Set(tag, terms.b[k]);
      const ComplexVector shape = {hn::MulAdd(a, x[m].re, hn::Mul(b, y.re)),
                                   hn::MulAdd(a, x[m].im, hn::Mul(b, y.im))};
      ComplexVector v = Times(Source(sensor.made)[m], shape);
      if (terms.extra) v = Sum(v, Source((*terms.extra)[k])[m]);
      along = Sum(along, Times(Source(sensor.told)[m], v));
      hn::StoreU(v.re, tag, column + k * length + m);
      hn::StoreU(v.im, tag, imaginary + k * length + m);
    }
    for (std::size_t k = 0; k < sensors; ++k) {
      const ComplexVector part = Times(Source(bins.sensors[k].weighted)[m], along);
      double *re = column + k * length + m, *im = imaginary + k * length + m;
      hn::StoreU(hn::Sub(part.re, hn::LoadU(tag, re)), tag, re);
      hn::StoreU(hn::Sub(part.im, hn::LoadU(tag, im)), tag, im);
    }
  }
}

// 1/(1 − step delay).
HWY_INLINE ComplexVector Ringing(ComplexVector delay, Complex step) {
  const Tag tag;
  const Vector one = hn::Set(tag, 1.0);
  const ComplexVector turn = Times(delay, {hn::Set(tag, step.real()), hn::Set(tag, step.imag())});
  const ComplexVector left = {hn::Sub(one, turn.re), hn::Neg(turn.im)};
  const Vector scale = hn::Div(one, Power(left));
  return {hn::Mul(left.re, scale), hn::Neg(hn::Mul(left.im, scale))};
}

void ShapeEnds(const PlanarVector& delay, Complex step, EndShapes& out) {
  const Source at(delay);
  const Target own(out.own), other(out.other);
  for (std::size_t m = 0; m < delay.size(); m += hn::Lanes(Tag())) {
    own.Set(m, Ringing(at[m], step));
    other.Set(m, Ringing(at[m], std::conj(step)));
  }
}

// U (r + t (U − 1)).
HWY_INLINE ComplexVector Rings(ComplexVector u, ComplexVector r, ComplexVector t) {
  const ComplexVector moved = {hn::Sub(u.re, hn::Set(Tag(), 1.0)), u.im};
  return Times(u, Sum(r, Times(t, moved)));
}

void AddEnds(const EndShapes& shapes, const AlignedVector& root, Complex r, Complex t,
             PlanarVector& to) {
  const Tag tag;
  const Source own(shapes.own), other(shapes.other), before(to);
  const Target after(to);
  const ComplexVector state = {hn::Set(tag, r.real()), hn::Set(tag, r.imag())},
                      rate = {hn::Set(tag, t.real()), hn::Set(tag, t.imag())};
  const ComplexVector state_other = {state.re, hn::Neg(state.im)},
                      rate_other = {rate.re, hn::Neg(rate.im)};
  for (std::size_t m = 0; m < to.size(); m += hn::Lanes(tag)) {
    const ComplexVector both =
        Sum(Rings(own[m], state, rate), Rings(other[m], state_other, rate_other));
    after.Set(m, Sum(before[m], Scaled(both, hn::Load(tag, root.data() + m))));
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(ShapeMode);
HWY_EXPORT(ProjectColumn);
HWY_EXPORT(ShapeEnds);
HWY_EXPORT(AddEnds);

ModeShapes::ModeShapes(std::size_t bins)
    : inverse(bins),
      by_omega(bins),
      by_zeta(bins),
      low_omega(bins),
      low_zeta(bins),
      low(bins),
      high_omega(bins),
      high_zeta(bins),
      high(bins) {}

void shape_mode(const BlindBins& bins, const ModalPole& pole, ModeShapes& out) {
  HWY_DYNAMIC_DISPATCH(ShapeMode)(bins, pole, out);
}

void project_column(const BlindBins& bins, const ColumnTerms& terms, double* column) {
  HWY_DYNAMIC_DISPATCH(ProjectColumn)(bins, terms, column);
}

void shape_ends(const PlanarVector& delay, Complex step, EndShapes& out) {
  HWY_DYNAMIC_DISPATCH(ShapeEnds)(delay, step, out);
}

void add_ends(const EndShapes& shapes, const AlignedVector& root, Complex r, Complex t,
              PlanarVector& to) {
  HWY_DYNAMIC_DISPATCH(AddEnds)(shapes, root, r, t, to);
}
}  // namespace modcal
#endif
