// Complex numbers side by side in vectors, for kernels that Highway compiles once an instruction
// set: included once for each of them, hence the guard that toggles.
#if defined(MODCAL_PLANAR_COMPLEX_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODCAL_PLANAR_COMPLEX_INL
#undef MODCAL_PLANAR_COMPLEX_INL
#else
#define MODCAL_PLANAR_COMPLEX_INL
#endif

#include <hwy/highway.h>

#include <complex>

#include "libcalib/likelihood/likelihood_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
constexpr std::size_t kBins = WhitenedRecord::kBlock;

struct C {
  V re, im;
};

HWY_INLINE V Real(double x) { return hn::Set(D(), x); }
HWY_INLINE C Make(V re, V im) { return {re, im}; }
HWY_INLINE C Set(std::complex<double> z) { return {Real(z.real()), Real(z.imag())}; }
HWY_INLINE C Zero() { return {hn::Zero(D()), hn::Zero(D())}; }
HWY_INLINE V LoadReal(const double* x) { return hn::Load(D(), x); }
HWY_INLINE C Load(const double* re, const double* im) {
  return {hn::Load(D(), re), hn::Load(D(), im)};
}
HWY_INLINE C Load(const LikelihoodBlock::Planar& z, std::size_t k) {
  return Load(z.re + k, z.im + k);
}
HWY_INLINE C Load(const PlanarVector& z, std::size_t k) {
  return Load(z.re.data() + k, z.im.data() + k);
}
HWY_INLINE void Store(C z, double* re, double* im) {
  hn::Store(z.re, D(), re);
  hn::Store(z.im, D(), im);
}
HWY_INLINE void Store(C z, LikelihoodBlock::Planar& to, std::size_t k) {
  Store(z, to.re + k, to.im + k);
}
HWY_INLINE C LoadColumn(const double* column, std::size_t k) {
  return Load(column + k, column + kBins + k);
}
HWY_INLINE void StoreColumn(C z, double* column, std::size_t k) {
  Store(z, column + k, column + kBins + k);
}
HWY_INLINE C Add(C a, C b) { return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)}; }
HWY_INLINE C Sub(C a, C b) { return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)}; }
HWY_INLINE C Scale(C a, V s) { return {hn::Mul(a.re, s), hn::Mul(a.im, s)}; }
HWY_INLINE C AddScaled(C sum, C a, V s) {
  return {hn::MulAdd(a.re, s, sum.re), hn::MulAdd(a.im, s, sum.im)};
}
HWY_INLINE C Mul(C a, C b) {
  return {hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re)),
          hn::MulAdd(a.im, b.re, hn::Mul(a.re, b.im))};
}
HWY_INLINE C ConjMul(C a, C b) {  // conj(a) b
  return {hn::MulAdd(a.im, b.im, hn::Mul(a.re, b.re)),
          hn::NegMulAdd(a.im, b.re, hn::Mul(a.re, b.im))};
}
HWY_INLINE C AddMul(C sum, C a, C b) {  // sum + a b
  return {hn::NegMulAdd(a.im, b.im, hn::MulAdd(a.re, b.re, sum.re)),
          hn::MulAdd(a.im, b.re, hn::MulAdd(a.re, b.im, sum.im))};
}
HWY_INLINE C AddConjMul(C sum, C a, C b) {  // sum + conj(a) b
  return {hn::MulAdd(a.im, b.im, hn::MulAdd(a.re, b.re, sum.re)),
          hn::NegMulAdd(a.im, b.re, hn::MulAdd(a.re, b.im, sum.im))};
}
HWY_INLINE V Norm(C a) { return hn::MulAdd(a.im, a.im, hn::Mul(a.re, a.re)); }
HWY_INLINE C Inverse(C a) {
  const V scale = hn::Div(Real(1.0), Norm(a));
  return {hn::Mul(a.re, scale), hn::Neg(hn::Mul(a.im, scale))};
}
HWY_INLINE double Sum(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }
HWY_INLINE std::complex<double> Sum(C z) { return {Sum(z.re), Sum(z.im)}; }

// U = 1/(1 − E z^−1) and U' = 1/(1 − conj(E) z^−1), one division for both.
struct Decays {
  C u, u_conj;
};
HWY_INLINE Decays DecaysAt(std::complex<double> pole, C delay) {
  const V re = Real(pole.real());
  const V im = Real(pole.imag());
  const V rr = hn::NegMulAdd(re, delay.re, Real(1.0));  // 1 − Re E Re z^−1
  const V ri = hn::Mul(re, delay.im);
  const V ii = hn::Mul(im, delay.im);
  const V ir = hn::Mul(im, delay.re);
  const C a{hn::Add(rr, ii), hn::Add(ri, ir)};  // conj(1 − E z^−1)
  const C b{hn::Sub(rr, ii), hn::Sub(ri, ir)};  // conj(1 − conj(E) z^−1)
  const V a_norm = Norm(a);
  const V b_norm = Norm(b);
  const V inverse = hn::Div(Real(1.0), hn::Mul(a_norm, b_norm));
  return {Scale(a, hn::Mul(b_norm, inverse)), Scale(b, hn::Mul(a_norm, inverse))};
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
