#include "libinverse/joint/bin_kernels.hpp"

#include <cassert>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/joint/bin_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<double>;
using Vector = hn::Vec<Lanes>;

// Whole vectors first, then one by one what a length leaves.
template <class Body>
HWY_INLINE void ForBins(std::size_t bins, Body body) {
  const Lanes d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t k = 0;
  for (; k + lanes <= bins; k += lanes) body(d, k);
  const hn::CappedTag<double, 1> one;
  for (; k < bins; ++k) body(one, k);
}

HWY_INLINE const double* Parts(const Complex* values) {
  return reinterpret_cast<const double*>(values);
}
HWY_INLINE double* Parts(Complex* values) { return reinterpret_cast<double*>(values); }

void CombineSides(double weight0, double weight1, const Complex* h0, const Complex* h1,
                  const Complex* x1, Complex* x0, double* gain, std::size_t bins) {
  ForBins(bins, [&](auto d, std::size_t k) HWY_ATTR {
    using V = hn::Vec<decltype(d)>;
    V a, b, c, e, x, y, z, w;
    hn::LoadInterleaved2(d, Parts(h0 + k), a, b);
    hn::LoadInterleaved2(d, Parts(h1 + k), c, e);
    hn::LoadInterleaved2(d, Parts(x0 + k), x, y);
    hn::LoadInterleaved2(d, Parts(x1 + k), z, w);
    const V w0 = hn::Set(d, weight0), w1 = hn::Set(d, weight1);
    const V power0 = hn::MulAdd(a, a, hn::Mul(b, b)), power1 = hn::MulAdd(c, c, hn::Mul(e, e));
    hn::StoreU(hn::MulAdd(w0, power0, hn::Mul(w1, power1)), d, gain + k);
    // conj(a + ib)(x + iy) = ax + by + i(ay − bx)
    const V real = hn::MulAdd(w0, hn::MulAdd(a, x, hn::Mul(b, y)),
                              hn::Mul(w1, hn::MulAdd(c, z, hn::Mul(e, w))));
    const V imag = hn::MulAdd(w0, hn::NegMulAdd(b, x, hn::Mul(a, y)),
                              hn::Mul(w1, hn::NegMulAdd(e, z, hn::Mul(c, w))));
    hn::StoreInterleaved2(real, imag, d, Parts(x0 + k));
  });
}

double CrossMisfit(double variance0, double variance1, double scale, const Complex* h0,
                   const Complex* h1, const Complex* x0, const Complex* x1, double* misfit,
                   std::size_t bins) {
  Vector sum = hn::Zero(Lanes());
  double rest = 0.0;
  ForBins(bins, [&](auto d, std::size_t k) HWY_ATTR {
    using V = hn::Vec<decltype(d)>;
    V a, b, c, e, x, y, z, w;
    hn::LoadInterleaved2(d, Parts(h0 + k), a, b);
    hn::LoadInterleaved2(d, Parts(h1 + k), c, e);
    hn::LoadInterleaved2(d, Parts(x0 + k), x, y);
    hn::LoadInterleaved2(d, Parts(x1 + k), z, w);
    // (x + iy)(c + ie) − (z + iw)(a + ib)
    const V real = hn::Sub(hn::NegMulAdd(y, e, hn::Mul(x, c)), hn::NegMulAdd(w, b, hn::Mul(z, a)));
    const V imag = hn::Sub(hn::MulAdd(x, e, hn::Mul(y, c)), hn::MulAdd(z, b, hn::Mul(w, a)));
    const V noise = hn::MulAdd(hn::Set(d, variance0), hn::MulAdd(c, c, hn::Mul(e, e)),
                               hn::Mul(hn::Set(d, variance1), hn::MulAdd(a, a, hn::Mul(b, b))));
    const V power = hn::MulAdd(real, real, hn::Mul(imag, imag));
    const V one = hn::Set(d, 1.0);
    const auto seen = hn::Gt(noise, hn::Zero(d));
    const V value = hn::IfThenElse(seen, hn::Div(hn::Mul(power, hn::Set(d, scale)), noise), one);
    hn::StoreU(value, d, misfit + k);
    if constexpr (std::is_same_v<decltype(d), Lanes>) {
      sum = hn::Add(sum, value);
    } else {
      rest += hn::GetLane(value);
    }
  });
  return hn::GetLane(hn::SumOfLanes(Lanes(), sum)) + rest;
}

void ScaledPower(const Complex* data, double scale, double* power, std::size_t bins) {
  ForBins(bins, [&](auto d, std::size_t k) HWY_ATTR {
    hn::Vec<decltype(d)> x, y;
    hn::LoadInterleaved2(d, Parts(data + k), x, y);
    hn::StoreU(hn::Mul(hn::Set(d, scale), hn::MulAdd(x, x, hn::Mul(y, y))), d, power + k);
  });
}

void EvidenceTerms(const double* gain, const double* prior, const double* power, double scale,
                   double* g, double* reduced, double* solution, std::size_t bins) {
  ForBins(bins, [&](auto d, std::size_t k) HWY_ATTR {
    const auto q = hn::LoadU(d, gain + k);
    const auto inverse = hn::IfThenElseZero(hn::Gt(q, hn::Zero(d)), hn::Div(hn::Set(d, 1.0), q));
    const auto u = hn::Mul(hn::Mul(hn::Set(d, 2.0), hn::LoadU(d, power + k)), inverse);
    hn::StoreU(hn::Mul(hn::Mul(q, hn::Set(d, scale)), hn::LoadU(d, prior + k)), d, g + k);
    hn::StoreU(u, d, reduced + k);
    hn::StoreU(hn::Mul(u, inverse), d, solution + k);
  });
}

void ExpectedPower(const double* gain, const double* power, double* prior, std::size_t bins) {
  ForBins(bins, [&](auto d, std::size_t k) HWY_ATTR {
    const auto variance = hn::LoadU(d, prior + k);
    const auto posterior =
        hn::Div(variance, hn::MulAdd(hn::LoadU(d, gain + k), variance, hn::Set(d, 1.0)));
    const auto share = hn::Mul(hn::LoadU(d, power + k), posterior);
    hn::StoreU(hn::MulAdd(share, posterior, posterior), d, prior + k);
  });
}

double ApplyPosterior(const double* gain, double* prior, Complex* data, std::size_t bins) {
  Vector sum = hn::Zero(Lanes());
  double rest = 0.0;
  ForBins(bins, [&](auto d, std::size_t k) HWY_ATTR {
    hn::Vec<decltype(d)> x, y;
    const auto q = hn::LoadU(d, gain + k);
    const auto variance = hn::LoadU(d, prior + k);
    const auto posterior = hn::Div(variance, hn::MulAdd(q, variance, hn::Set(d, 1.0)));
    hn::StoreU(posterior, d, prior + k);
    hn::LoadInterleaved2(d, Parts(data + k), x, y);
    hn::StoreInterleaved2(hn::Mul(x, posterior), hn::Mul(y, posterior), d, Parts(data + k));
    if constexpr (std::is_same_v<decltype(d), Lanes>) {
      sum = hn::MulAdd(q, posterior, sum);
    } else {
      rest += hn::GetLane(hn::Mul(q, posterior));
    }
  });
  return hn::GetLane(hn::SumOfLanes(Lanes(), sum)) + rest;
}

double ThroughTransfer(const Complex* transfer, const Complex* data, const double* variance,
                       Complex* out, std::size_t bins) {
  Vector sum = hn::Zero(Lanes());
  double rest = 0.0;
  ForBins(bins, [&](auto d, std::size_t k) HWY_ATTR {
    using V = hn::Vec<decltype(d)>;
    V a, b, x, y;
    hn::LoadInterleaved2(d, Parts(transfer + k), a, b);
    hn::LoadInterleaved2(d, Parts(data + k), x, y);
    hn::StoreInterleaved2(hn::NegMulAdd(b, y, hn::Mul(a, x)), hn::MulAdd(a, y, hn::Mul(b, x)), d,
                          Parts(out + k));
    const V gain = hn::MulAdd(a, a, hn::Mul(b, b));
    const V p = hn::LoadU(d, variance + k);
    if constexpr (std::is_same_v<decltype(d), Lanes>) {
      sum = hn::MulAdd(gain, p, sum);
    } else {
      rest += hn::GetLane(hn::Mul(gain, p));
    }
  });
  return hn::GetLane(hn::SumOfLanes(Lanes(), sum)) + rest;
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(CombineSides);
HWY_EXPORT(CrossMisfit);
HWY_EXPORT(ScaledPower);
HWY_EXPORT(EvidenceTerms);
HWY_EXPORT(ExpectedPower);
HWY_EXPORT(ApplyPosterior);
HWY_EXPORT(ThroughTransfer);

void combine_sides(std::array<double, 2> weight, std::span<const Complex> transfer0,
                   std::span<const Complex> transfer1, std::span<const Complex> spectrum1,
                   std::span<Complex> spectrum0, std::span<double> gain) {
  assert(transfer0.size() == gain.size() && transfer1.size() == gain.size() &&
         spectrum0.size() == gain.size() && spectrum1.size() == gain.size());
  HWY_DYNAMIC_DISPATCH(CombineSides)
  (weight[0], weight[1], transfer0.data(), transfer1.data(), spectrum1.data(), spectrum0.data(),
   gain.data(), gain.size());
}

double cross_misfit(std::array<double, 2> noise_variance, double scale,
                    std::span<const Complex> transfer0, std::span<const Complex> transfer1,
                    std::span<const Complex> spectrum0, std::span<const Complex> spectrum1,
                    std::span<double> misfit) {
  assert(transfer0.size() == misfit.size() && transfer1.size() == misfit.size() &&
         spectrum0.size() == misfit.size() && spectrum1.size() == misfit.size());
  return HWY_DYNAMIC_DISPATCH(CrossMisfit)(noise_variance[0], noise_variance[1], scale,
                                           transfer0.data(), transfer1.data(), spectrum0.data(),
                                           spectrum1.data(), misfit.data(), misfit.size());
}

void scaled_power(std::span<const Complex> data, double scale, std::span<double> power) {
  assert(data.size() == power.size());
  HWY_DYNAMIC_DISPATCH(ScaledPower)(data.data(), scale, power.data(), power.size());
}

void evidence_terms(std::span<const double> gain, std::span<const double> prior,
                    std::span<const double> power, double scale, std::span<double> g,
                    std::span<double> reduced, std::span<double> solution) {
  assert(prior.size() == gain.size() && power.size() == gain.size() && g.size() == gain.size() &&
         reduced.size() == gain.size() && solution.size() == gain.size());
  HWY_DYNAMIC_DISPATCH(EvidenceTerms)
  (gain.data(), prior.data(), power.data(), scale, g.data(), reduced.data(), solution.data(),
   gain.size());
}

void expected_power(std::span<const double> gain, std::span<const double> power,
                    std::span<double> prior) {
  assert(gain.size() == prior.size() && power.size() == prior.size());
  HWY_DYNAMIC_DISPATCH(ExpectedPower)(gain.data(), power.data(), prior.data(), prior.size());
}

double apply_posterior(std::span<const double> gain, std::span<double> prior,
                       std::span<Complex> data) {
  assert(gain.size() == prior.size() && data.size() == prior.size());
  return HWY_DYNAMIC_DISPATCH(ApplyPosterior)(gain.data(), prior.data(), data.data(), prior.size());
}

double through_transfer(std::span<const Complex> transfer, std::span<const Complex> data,
                        std::span<const double> variance, std::span<Complex> out) {
  assert(transfer.size() == out.size() && data.size() == out.size() &&
         variance.size() == out.size());
  return HWY_DYNAMIC_DISPATCH(ThroughTransfer)(transfer.data(), data.data(), variance.data(),
                                               out.data(), out.size());
}
}  // namespace modcal
#endif
