// Transforms of a sampled free decay in the lanes of the machine. Compiled once for every
// instruction set: include it after <hwy/highway.h>, outside any namespace.
#if defined(MODCAL_SAMPLED_DECAY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODCAL_SAMPLED_DECAY_INL
#undef MODCAL_SAMPLED_DECAY_INL
#else
#define MODCAL_SAMPLED_DECAY_INL
#endif

#include <complex>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// U = 1/(1 − E z^−1) and U' = 1/(1 − conj(E) z^−1), one division for both, and their norms.
struct Decays {
  ComplexVector u, u_conj;
  Vector norm, norm_conj;
};
HWY_INLINE Decays DecaysAt(std::complex<double> pole, ComplexVector delay) {
  const Vector one = hn::Set(Tag(), 1.0);
  const Vector re = hn::Set(Tag(), pole.real());
  const Vector im = hn::Set(Tag(), pole.imag());
  const Vector rr = hn::NegMulAdd(re, delay.re, one);  // 1 − Re E Re z^−1
  const Vector ri = hn::Mul(re, delay.im);
  const Vector ii = hn::Mul(im, delay.im);
  const Vector ir = hn::Mul(im, delay.re);
  const ComplexVector a{hn::Add(rr, ii), hn::Add(ri, ir)};  // conj(1 − E z^−1)
  const ComplexVector b{hn::Sub(rr, ii), hn::Sub(ri, ir)};  // conj(1 − conj(E) z^−1)
  const Vector a_norm = hn::MulAdd(a.im, a.im, hn::Mul(a.re, a.re));
  const Vector b_norm = hn::MulAdd(b.im, b.im, hn::Mul(b.re, b.re));
  const Vector inverse = hn::Div(one, hn::Mul(a_norm, b_norm));
  const Vector norm = hn::Mul(b_norm, inverse);
  const Vector norm_conj = hn::Mul(a_norm, inverse);
  return {{hn::Mul(a.re, norm), hn::Mul(a.im, norm)},
          {hn::Mul(b.re, norm_conj), hn::Mul(b.im, norm_conj)},
          norm,
          norm_conj};
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
