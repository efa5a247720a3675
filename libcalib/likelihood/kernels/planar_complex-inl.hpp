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

#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"
#include "libcalib/likelihood/kernels/mode_split.hpp"
#include "libsim/base/kernels/sampled_decay-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

using D = Tag;
using V = Vector;
using C = ComplexVector;
constexpr std::size_t kBins = WhitenedRecord::kBlock;
constexpr std::size_t kNodes = WhitenedRecord::kNodes;

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
// Variance of h_2n_1 − h_1n_2 under E|n_1|², E|n_2|², E n_1 conj(n_2).
HWY_INLINE V ResidualVariance(C h1, C h2, V first, V second, V mixed) {
  const V both = hn::MulAdd(h1.re, h2.re, hn::Mul(h1.im, h2.im));
  const V alone = hn::MulAdd(second, Norm(h1), hn::Mul(first, Norm(h2)));
  return hn::NegMulAdd(hn::Mul(Real(2.0), mixed), both, alone);
}
HWY_INLINE double Sum(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }
HWY_INLINE std::complex<double> Sum(C z) { return {Sum(z.re), Sum(z.im)}; }

// s_k and s_k² of neighboring bins or nodes.
struct Bins {
  C s, s_squared;
};
HWY_INLINE Bins BinsAt(const double* omega_at, double sigma_at) {
  const V omega = LoadReal(omega_at);
  const V sigma = Real(sigma_at);
  return {Make(sigma, omega), Make(hn::NegMulAdd(omega, omega, hn::Mul(sigma, sigma)),
                                   hn::Mul(Real(2.0 * sigma_at), omega))};
}
HWY_INLINE C InverseDenominator(const LikelihoodMode& mode, const Bins& bins) {
  const V damping = Real(mode.two_zeta_omega);
  return Inverse(
      Make(hn::MulAdd(damping, bins.s.re, hn::Add(bins.s_squared.re, Real(mode.omega_squared))),
           hn::MulAdd(damping, bins.s.im, bins.s_squared.im)));
}

// Where modes are evaluated: the bins of a block or its nodes.
struct Places {
  const double* omega;
  const double* delay_re;
  const double* delay_im;
  double sigma;
  std::size_t count;

  HWY_INLINE Bins BinsFrom(std::size_t k) const { return BinsAt(omega + k, sigma); }
  HWY_INLINE C Delay(std::size_t k) const {
    return modcal::HWY_NAMESPACE::Load(delay_re + k, delay_im + k);
  }
};
HWY_INLINE Places BinsOf(const WhitenedRecord& record, std::size_t block) {
  const std::size_t first = block * kBins;
  return {record.omega.data() + first, record.delay.re.data() + first,
          record.delay.im.data() + first, record.sigma, kBins};
}
HWY_INLINE Places NodesOf(const WhitenedRecord& record, std::size_t block) {
  const std::size_t first = block * kNodes;
  return {record.node_omega.data() + first, record.node_delay.re.data() + first,
          record.node_delay.im.data() + first, record.sigma, kNodes};
}

// Four numbers given at the nodes, kNodes each, at the bins k, k + 1, …
struct Four {
  V a, b, c, d;
};
HWY_INLINE Four Interpolate(const BlockNodes& basis, const double* nodes, std::size_t k) {
  Four sum{hn::Zero(D()), hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
  for (std::size_t j = 0; j < kNodes; ++j) {
    const V weight = LoadReal(basis.weight[j] + k);
    sum.a = hn::MulAdd(weight, Real(nodes[j]), sum.a);
    sum.b = hn::MulAdd(weight, Real(nodes[kNodes + j]), sum.b);
    sum.c = hn::MulAdd(weight, Real(nodes[2 * kNodes + j]), sum.c);
    sum.d = hn::MulAdd(weight, Real(nodes[3 * kNodes + j]), sum.d);
  }
  return sum;
}

// The adjoint: weights of the nodes that serve functions smooth across the block as the weights
// `bins` (fields of kBins, a multiple of four) do.
HWY_INLINE void Gather(const BlockNodes& basis, const double* bins, std::size_t fields,
                       double* nodes) {
  for (std::size_t f = 0; f < fields; f += 4) {
    const double* from = bins + f * kBins;
    double* to = nodes + f * kNodes;
    for (std::size_t j = 0; j < kNodes; j += 2) {
      Four even{hn::Zero(D()), hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
      Four odd = even;
      for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
        const V x = LoadReal(basis.weight[j] + k), y = LoadReal(basis.weight[j + 1] + k);
        const V a = LoadReal(from + k), b = LoadReal(from + kBins + k),
                c = LoadReal(from + 2 * kBins + k), d = LoadReal(from + 3 * kBins + k);
        even.a = hn::MulAdd(x, a, even.a), odd.a = hn::MulAdd(y, a, odd.a);
        even.b = hn::MulAdd(x, b, even.b), odd.b = hn::MulAdd(y, b, odd.b);
        even.c = hn::MulAdd(x, c, even.c), odd.c = hn::MulAdd(y, c, odd.c);
        even.d = hn::MulAdd(x, d, even.d), odd.d = hn::MulAdd(y, d, odd.d);
      }
      to[j] = Sum(even.a), to[j + 1] = Sum(odd.a);
      to[kNodes + j] = Sum(even.b), to[kNodes + j + 1] = Sum(odd.b);
      to[2 * kNodes + j] = Sum(even.c), to[2 * kNodes + j + 1] = Sum(odd.c);
      to[3 * kNodes + j] = Sum(even.d), to[3 * kNodes + j + 1] = Sum(odd.d);
    }
  }
}

// A sum over bins that ends up as one number keeps its lanes until all blocks are through.
HWY_INLINE void AddLanes(double* lanes, V v) { hn::Store(hn::Add(LoadReal(lanes), v), D(), lanes); }
HWY_INLINE double SumOfLanes(const double* lanes) { return Sum(LoadReal(lanes)); }

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
