#include "libinverse/joint/ringing_columns.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/joint/ringing_columns.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/kernels/sampled_decay-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

HWY_INLINE ComplexVector ScaledBy(ComplexVector z, Vector s) {
  return {hn::Mul(z.re, s), hn::Mul(z.im, s)};
}
HWY_INLINE ComplexVector PlusScaled(ComplexVector sum, ComplexVector z, Vector s) {
  return {hn::MulAdd(z.re, s, sum.re), hn::MulAdd(z.im, s, sum.im)};
}
HWY_INLINE void StoreAt(ComplexVector z, double* re, double* im) {
  hn::Store(z.re, Tag(), re);
  hn::Store(z.im, Tag(), im);
}

void FillRingingColumns(std::span<const RingingMode> modes, const PlanarVector& delay,
                        const RingingFactors& factors, double* columns) {
  const std::size_t bins = delay.size();
  const Source delays(delay), lefts(factors.left), rights(factors.right);
  const double* weights = factors.own.data();
  const Vector half = hn::Set(Tag(), 0.5);
  for (const RingingMode& mode : modes) {
    const Vector left = hn::Set(Tag(), mode.left), right = hn::Set(Tag(), mode.right);
    const Vector own_re = hn::Set(Tag(), mode.own.real());
    const Vector own_im = hn::Set(Tag(), mode.own.imag());
    double* second = columns + kColumnLength;
    for (std::size_t k = 0; k < bins; k += hn::Lanes(Tag())) {
      const Decays decays = DecaysAt(mode.pole, delays[k]);
      const Vector weight = hn::Mul(half, hn::Load(Tag(), weights + k));
      ComplexVector f = ScaledBy(PlusScaled(ScaledBy(lefts[k], left), rights[k], right), half);
      f.re = hn::MulAdd(own_re, weight, f.re);
      const Vector turned = hn::Mul(own_im, weight);
      // 2 D(1) and 2 D(i).
      const ComplexVector one{hn::Add(decays.u.re, decays.u_conj.re),
                              hn::Add(decays.u.im, decays.u_conj.im)};
      const ComplexVector other{hn::Sub(decays.u_conj.im, decays.u.im),
                                hn::Sub(decays.u.re, decays.u_conj.re)};
      StoreAt(PlusScaled(Times(f, one), other, turned), columns + k, columns + bins + k);
      StoreAt(PlusScaled(Times(f, other), one, hn::Neg(turned)), second + k, second + bins + k);
    }
    columns += 2 * kColumnLength;
  }
}

void AddRinging(std::span<const RingingMode> modes, const PlanarVector& delay, PlanarVector& left,
                PlanarVector& right) {
  const Source delays(delay), lefts(left), rights(right);
  const Target to_left(left), to_right(right);
  for (std::size_t k = 0; k < delay.size(); k += hn::Lanes(Tag())) {
    ComplexVector left_sum = lefts[k], right_sum = rights[k];
    for (const RingingMode& mode : modes) {
      const Decays decays = DecaysAt(mode.pole, delays[k]);
      const ComplexVector c{hn::Set(Tag(), 0.5 * mode.own.real()),
                            hn::Set(Tag(), 0.5 * mode.own.imag())};
      const ComplexVector one = Times(c, decays.u);
      const ComplexVector other = Times({c.re, hn::Neg(c.im)}, decays.u_conj);
      const ComplexVector sum{hn::Add(one.re, other.re), hn::Add(one.im, other.im)};
      left_sum = PlusScaled(left_sum, sum, hn::Set(Tag(), mode.left));
      right_sum = PlusScaled(right_sum, sum, hn::Set(Tag(), mode.right));
    }
    to_left.Set(k, left_sum);
    to_right.Set(k, right_sum);
  }
}

void Smear(std::span<const double> lines, const double* from, std::size_t count, double* to) {
  const double* middle = from + lines.size() - 1;
  for (std::size_t k = 0; k < count; k += hn::Lanes(Tag())) {
    Vector sum = hn::Mul(hn::Set(Tag(), lines[0]), hn::LoadU(Tag(), middle + k));
    for (std::size_t m = 1; m < lines.size(); ++m) {
      const Vector both =
          hn::Add(hn::LoadU(Tag(), middle + k - m), hn::LoadU(Tag(), middle + k + m));
      sum = hn::MulAdd(hn::Set(Tag(), lines[m]), both, sum);
    }
    hn::Store(sum, Tag(), to + k);
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(FillRingingColumns);
HWY_EXPORT(AddRinging);
HWY_EXPORT(Smear);

void fill_ringing_columns(std::span<const RingingMode> modes, const PlanarVector& delay,
                          const RingingFactors& factors, double* columns) {
  HWY_DYNAMIC_DISPATCH(FillRingingColumns)(modes, delay, factors, columns);
}

void add_ringing(std::span<const RingingMode> modes, const PlanarVector& delay, PlanarVector& left,
                 PlanarVector& right) {
  HWY_DYNAMIC_DISPATCH(AddRinging)(modes, delay, left, right);
}

void smear(std::span<const double> lines, const double* from, std::size_t count, double* to) {
  HWY_DYNAMIC_DISPATCH(Smear)(lines, from, count, to);
}
}  // namespace modcal
#endif
