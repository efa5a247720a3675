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

using Spectrum = std::span<const Complex>;
using Values = std::span<const double>;

HWY_INLINE const double* Parts(Spectrum values, std::size_t k) {
  return reinterpret_cast<const double*>(values.data() + k);
}
HWY_INLINE double* Parts(std::span<Complex> values, std::size_t k) {
  return reinterpret_cast<double*>(values.data() + k);
}

void CombineSides(std::array<double, 2> weight, Spectrum h0, Spectrum h1, Spectrum x1,
                  std::span<Complex> x0, std::span<double> gain) {
  assert(h0.size() == gain.size() && h1.size() == gain.size() && x0.size() == gain.size() &&
         x1.size() == gain.size());
  ForBins(gain.size(), [&](auto d, std::size_t k) HWY_ATTR {
    using V = hn::Vec<decltype(d)>;
    V a, b, c, e, x, y, z, w;
    hn::LoadInterleaved2(d, Parts(h0, k), a, b);
    hn::LoadInterleaved2(d, Parts(h1, k), c, e);
    hn::LoadInterleaved2(d, Parts(x0, k), x, y);
    hn::LoadInterleaved2(d, Parts(x1, k), z, w);
    const V w0 = hn::Set(d, weight[0]), w1 = hn::Set(d, weight[1]);
    const V power0 = hn::MulAdd(a, a, hn::Mul(b, b)), power1 = hn::MulAdd(c, c, hn::Mul(e, e));
    hn::StoreU(hn::MulAdd(w0, power0, hn::Mul(w1, power1)), d, gain.data() + k);
    // conj(a + ib)(x + iy) = ax + by + i(ay − bx)
    const V real = hn::MulAdd(w0, hn::MulAdd(a, x, hn::Mul(b, y)),
                              hn::Mul(w1, hn::MulAdd(c, z, hn::Mul(e, w))));
    const V imag = hn::MulAdd(w0, hn::NegMulAdd(b, x, hn::Mul(a, y)),
                              hn::Mul(w1, hn::NegMulAdd(e, z, hn::Mul(c, w))));
    hn::StoreInterleaved2(real, imag, d, Parts(x0, k));
  });
}

double CrossMisfit(std::array<double, 2> variance, double scale, Spectrum h0, Spectrum h1,
                   Spectrum x0, Spectrum x1, std::span<double> misfit) {
  assert(h0.size() == misfit.size() && h1.size() == misfit.size() && x0.size() == misfit.size() &&
         x1.size() == misfit.size());
  Vector sum = hn::Zero(Lanes());
  double rest = 0.0;
  ForBins(misfit.size(), [&](auto d, std::size_t k) HWY_ATTR {
    using V = hn::Vec<decltype(d)>;
    V a, b, c, e, x, y, z, w;
    hn::LoadInterleaved2(d, Parts(h0, k), a, b);
    hn::LoadInterleaved2(d, Parts(h1, k), c, e);
    hn::LoadInterleaved2(d, Parts(x0, k), x, y);
    hn::LoadInterleaved2(d, Parts(x1, k), z, w);
    // (x + iy)(c + ie) − (z + iw)(a + ib)
    const V real = hn::Sub(hn::NegMulAdd(y, e, hn::Mul(x, c)), hn::NegMulAdd(w, b, hn::Mul(z, a)));
    const V imag = hn::Sub(hn::MulAdd(x, e, hn::Mul(y, c)), hn::MulAdd(z, b, hn::Mul(w, a)));
    const V noise = hn::MulAdd(hn::Set(d, variance[0]), hn::MulAdd(c, c, hn::Mul(e, e)),
                               hn::Mul(hn::Set(d, variance[1]), hn::MulAdd(a, a, hn::Mul(b, b))));
    const V power = hn::MulAdd(real, real, hn::Mul(imag, imag));
    const V one = hn::Set(d, 1.0);
    const auto seen = hn::Gt(noise, hn::Zero(d));
    const V value = hn::IfThenElse(seen, hn::Div(hn::Mul(power, hn::Set(d, scale)), noise), one);
    hn::StoreU(value, d, misfit.data() + k);
    if constexpr (std::is_same_v<decltype(d), Lanes>) {
      sum = hn::Add(sum, value);
    } else {
      rest += hn::GetLane(value);
    }
  });
  return hn::GetLane(hn::SumOfLanes(Lanes(), sum)) + rest;
}

void ScaledPower(Spectrum data, double scale, std::span<double> power) {
  assert(data.size() == power.size());
  ForBins(power.size(), [&](auto d, std::size_t k) HWY_ATTR {
    hn::Vec<decltype(d)> x, y;
    hn::LoadInterleaved2(d, Parts(data, k), x, y);
    hn::StoreU(hn::Mul(hn::Set(d, scale), hn::MulAdd(x, x, hn::Mul(y, y))), d, power.data() + k);
  });
}

void EvidenceTerms(Values gain, Values prior, Values power, double scale, std::span<double> g,
                   std::span<double> reduced, std::span<double> solution) {
  assert(prior.size() == gain.size() && power.size() == gain.size() && g.size() == gain.size() &&
         reduced.size() == gain.size() && solution.size() == gain.size());
  ForBins(gain.size(), [&](auto d, std::size_t k) HWY_ATTR {
    const auto q = hn::LoadU(d, gain.data() + k);
    const auto inverse = hn::IfThenElseZero(hn::Gt(q, hn::Zero(d)), hn::Div(hn::Set(d, 1.0), q));
    const auto u = hn::Mul(hn::Mul(hn::Set(d, 2.0), hn::LoadU(d, power.data() + k)), inverse);
    hn::StoreU(hn::Mul(hn::Mul(q, hn::Set(d, scale)), hn::LoadU(d, prior.data() + k)), d,
               g.data() + k);
    hn::StoreU(u, d, reduced.data() + k);
    hn::StoreU(hn::Mul(u, inverse), d, solution.data() + k);
  });
}

void ExpectedPower(Values gain, Values power, std::span<double> prior) {
  assert(gain.size() == prior.size() && power.size() == prior.size());
  ForBins(prior.size(), [&](auto d, std::size_t k) HWY_ATTR {
    const auto variance = hn::LoadU(d, prior.data() + k);
    const auto posterior =
        hn::Div(variance, hn::MulAdd(hn::LoadU(d, gain.data() + k), variance, hn::Set(d, 1.0)));
    const auto share = hn::Mul(hn::LoadU(d, power.data() + k), posterior);
    hn::StoreU(hn::MulAdd(share, posterior, posterior), d, prior.data() + k);
  });
}

double ApplyPosterior(Values gain, std::span<double> prior, std::span<Complex> data) {
  assert(gain.size() == prior.size() && data.size() == prior.size());
  Vector sum = hn::Zero(Lanes());
  double rest = 0.0;
  ForBins(prior.size(), [&](auto d, std::size_t k) HWY_ATTR {
    hn::Vec<decltype(d)> x, y;
    const auto q = hn::LoadU(d, gain.data() + k);
    const auto variance = hn::LoadU(d, prior.data() + k);
    const auto posterior = hn::Div(variance, hn::MulAdd(q, variance, hn::Set(d, 1.0)));
    hn::StoreU(posterior, d, prior.data() + k);
    hn::LoadInterleaved2(d, Parts(data, k), x, y);
    hn::StoreInterleaved2(hn::Mul(x, posterior), hn::Mul(y, posterior), d, Parts(data, k));
    if constexpr (std::is_same_v<decltype(d), Lanes>) {
      sum = hn::MulAdd(q, posterior, sum);
    } else {
      rest += hn::GetLane(hn::Mul(q, posterior));
    }
  });
  return hn::GetLane(hn::SumOfLanes(Lanes(), sum)) + rest;
}

double ThroughTransfer(Spectrum transfer, Spectrum data, Values variance, std::span<Complex> out) {
  assert(transfer.size() == out.size() && data.size() == out.size() &&
         variance.size() == out.size());
  Vector sum = hn::Zero(Lanes());
  double rest = 0.0;
  ForBins(out.size(), [&](auto d, std::size_t k) HWY_ATTR {
    using V = hn::Vec<decltype(d)>;
    V a, b, x, y;
    hn::LoadInterleaved2(d, Parts(transfer, k), a, b);
    hn::LoadInterleaved2(d, Parts(data, k), x, y);
    hn::StoreInterleaved2(hn::NegMulAdd(b, y, hn::Mul(a, x)), hn::MulAdd(a, y, hn::Mul(b, x)), d,
                          Parts(out, k));
    const V gain = hn::MulAdd(a, a, hn::Mul(b, b));
    const V p = hn::LoadU(d, variance.data() + k);
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
  HWY_DYNAMIC_DISPATCH(CombineSides)(weight, transfer0, transfer1, spectrum1, spectrum0, gain);
}

double cross_misfit(std::array<double, 2> noise_variance, double scale,
                    std::span<const Complex> transfer0, std::span<const Complex> transfer1,
                    std::span<const Complex> spectrum0, std::span<const Complex> spectrum1,
                    std::span<double> misfit) {
  return HWY_DYNAMIC_DISPATCH(CrossMisfit)(noise_variance, scale, transfer0, transfer1, spectrum0,
                                           spectrum1, misfit);
}

void scaled_power(std::span<const Complex> data, double scale, std::span<double> power) {
  HWY_DYNAMIC_DISPATCH(ScaledPower)(data, scale, power);
}

void evidence_terms(std::span<const double> gain, std::span<const double> prior,
                    std::span<const double> power, double scale, std::span<double> g,
                    std::span<double> reduced, std::span<double> solution) {
  HWY_DYNAMIC_DISPATCH(EvidenceTerms)(gain, prior, power, scale, g, reduced, solution);
}

void expected_power(std::span<const double> gain, std::span<const double> power,
                    std::span<double> prior) {
  HWY_DYNAMIC_DISPATCH(ExpectedPower)(gain, power, prior);
}

double apply_posterior(std::span<const double> gain, std::span<double> prior,
                       std::span<Complex> data) {
  return HWY_DYNAMIC_DISPATCH(ApplyPosterior)(gain, prior, data);
}

double through_transfer(std::span<const Complex> transfer, std::span<const Complex> data,
                        std::span<const double> variance, std::span<Complex> out) {
  return HWY_DYNAMIC_DISPATCH(ThroughTransfer)(transfer, data, variance, out);
}
}  // namespace modcal
#endif
