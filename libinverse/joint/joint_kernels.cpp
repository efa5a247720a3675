#include "libinverse/joint/joint_kernels.hpp"

#include <cassert>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/joint/joint_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

using Lanes = hn::ScalableTag<double>;
using Lane = hn::Vec<Lanes>;

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

// A sum over bins, those in whole vectors apart from the rest.
struct BinSum {
  Lane lanes;
  double rest = 0.0;

  HWY_INLINE BinSum() : lanes(hn::Zero(Lanes())) {}
  template <class D, class V>
  HWY_INLINE void Add(D /*tag*/, V value) {
    if constexpr (std::is_same_v<D, Lanes>) {
      lanes = hn::Add(lanes, value);
    } else {
      rest += hn::GetLane(value);
    }
  }
  template <class D, class V>
  HWY_INLINE void AddProduct(D /*tag*/, V a, V b) {
    if constexpr (std::is_same_v<D, Lanes>) {
      lanes = hn::MulAdd(a, b, lanes);
    } else {
      rest += hn::GetLane(hn::Mul(a, b));
    }
  }
  HWY_INLINE double Total() const { return hn::GetLane(hn::SumOfLanes(Lanes(), lanes)) + rest; }
};

using Spectrum = std::span<const Complex>;
using Values = std::span<const double>;

template <class D>
HWY_INLINE ComplexOf<hn::Vec<D>> Bins(D d, Spectrum values, std::size_t k) {
  ComplexOf<hn::Vec<D>> z;
  hn::LoadInterleaved2(d, reinterpret_cast<const double*>(values.data() + k), z.re, z.im);
  return z;
}
template <class D, class V>
HWY_INLINE void Store(D d, V re, V im, std::span<Complex> values, std::size_t k) {
  hn::StoreInterleaved2(re, im, d, reinterpret_cast<double*>(values.data() + k));
}
// p = P/(1 + q P).
template <class D, class V>
HWY_INLINE V Posterior(D d, V gain, V variance) {
  return hn::Div(variance, hn::MulAdd(gain, variance, hn::Set(d, 1.0)));
}

void CombineSides(const std::array<double, 2>& weight, const SideSpectra& transfer,
                  SideSpectra& spectrum, std::span<double> gain) {
  const Spectrum h0 = transfer[0], h1 = transfer[1], x1 = spectrum[1];
  const std::span<Complex> x0 = spectrum[0];
  const double first = weight[0], second = weight[1];
  assert(h0.size() == gain.size() && h1.size() == gain.size() && x0.size() == gain.size() &&
         x1.size() == gain.size());
  ForBins(gain.size(), [&](auto d, std::size_t k) HWY_ATTR {
    const auto a = Bins(d, h0, k), b = Bins(d, h1, k), x = Bins(d, x0, k), y = Bins(d, x1, k);
    const auto w0 = hn::Set(d, first), w1 = hn::Set(d, second);
    hn::StoreU(hn::MulAdd(w0, Power(a), hn::Mul(w1, Power(b))), d, gain.data() + k);
    // conj(H) X
    const auto real = hn::MulAdd(w0, hn::MulAdd(a.re, x.re, hn::Mul(a.im, x.im)),
                                 hn::Mul(w1, hn::MulAdd(b.re, y.re, hn::Mul(b.im, y.im))));
    const auto imag = hn::MulAdd(w0, hn::NegMulAdd(a.im, x.re, hn::Mul(a.re, x.im)),
                                 hn::Mul(w1, hn::NegMulAdd(b.im, y.re, hn::Mul(b.re, y.im))));
    Store(d, real, imag, x0, k);
  });
}

double CrossMisfit(const std::array<double, 2>& noise_variance, double scale,
                   const SideSpectra& transfer, const SideSpectra& spectrum,
                   std::span<double> misfit) {
  const Spectrum h0 = transfer[0], h1 = transfer[1], x0 = spectrum[0], x1 = spectrum[1];
  const double first = noise_variance[0], second = noise_variance[1];
  assert(h0.size() == misfit.size() && h1.size() == misfit.size() && x0.size() == misfit.size() &&
         x1.size() == misfit.size());
  BinSum sum;
  ForBins(misfit.size(), [&](auto d, std::size_t k) HWY_ATTR {
    const auto a = Bins(d, h0, k), b = Bins(d, h1, k), x = Bins(d, x0, k), y = Bins(d, x1, k);
    const auto left = Times(x, b), right = Times(y, a);
    const decltype(left) apart{hn::Sub(left.re, right.re), hn::Sub(left.im, right.im)};
    const auto noise =
        hn::MulAdd(hn::Set(d, first), Power(b), hn::Mul(hn::Set(d, second), Power(a)));
    const auto seen = hn::Gt(noise, hn::Zero(d));
    const auto value = hn::IfThenElse(
        seen, hn::Div(hn::Mul(Power(apart), hn::Set(d, scale)), noise), hn::Set(d, 1.0));
    hn::StoreU(value, d, misfit.data() + k);
    sum.Add(d, value);
  });
  return sum.Total();
}

void ScaledPower(Spectrum data, double scale, std::span<double> power) {
  assert(data.size() == power.size());
  ForBins(power.size(), [&](auto d, std::size_t k) HWY_ATTR {
    hn::StoreU(hn::Mul(hn::Set(d, scale), Power(Bins(d, data, k))), d, power.data() + k);
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
    const auto posterior =
        Posterior(d, hn::LoadU(d, gain.data() + k), hn::LoadU(d, prior.data() + k));
    const auto share = hn::Mul(hn::LoadU(d, power.data() + k), posterior);
    hn::StoreU(hn::MulAdd(share, posterior, posterior), d, prior.data() + k);
  });
}

double ApplyPosterior(Values gain, std::span<double> prior, std::span<Complex> data) {
  assert(gain.size() == prior.size() && data.size() == prior.size());
  BinSum sum;
  ForBins(prior.size(), [&](auto d, std::size_t k) HWY_ATTR {
    const auto q = hn::LoadU(d, gain.data() + k);
    const auto posterior = Posterior(d, q, hn::LoadU(d, prior.data() + k));
    hn::StoreU(posterior, d, prior.data() + k);
    const auto x = Bins(d, data, k);
    Store(d, hn::Mul(x.re, posterior), hn::Mul(x.im, posterior), data, k);
    sum.AddProduct(d, q, posterior);
  });
  return sum.Total();
}

double ThroughTransfer(Spectrum transfer, Spectrum data, Values variance, std::span<Complex> out) {
  assert(transfer.size() == out.size() && data.size() == out.size() &&
         variance.size() == out.size());
  BinSum sum;
  ForBins(out.size(), [&](auto d, std::size_t k) HWY_ATTR {
    const auto h = Bins(d, transfer, k), product = Times(h, Bins(d, data, k));
    Store(d, product.re, product.im, out, k);
    sum.AddProduct(d, Power(h), hn::LoadU(d, variance.data() + k));
  });
  return sum.Total();
}

// log₂ g: with the mantissa m and y = (m − 1)/(m + 1), log m = 2 artanh y. The exponent is exact,
// so that powers of two shift cells by whole octaves.
template <class D, class V>
HWY_INLINE V FastLog2(D d, V value) {
  const hn::RebindToSigned<D> di;
  const auto bits = hn::BitCast(di, value);
  const auto exponent = hn::ConvertTo(d, hn::Sub(hn::ShiftRight<52>(bits), hn::Set(di, 1023)));
  const V mantissa = hn::BitCast(
      d, hn::Or(hn::And(bits, hn::Set(di, 0x000fffffffffffff)), hn::Set(di, 0x3ff0000000000000)));
  const V one = hn::Set(d, 1.0);
  const V y = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one));
  const V z = hn::Mul(y, y);
  V series = hn::MulAdd(z, hn::Set(d, 1.0 / 7.0), hn::Set(d, 0.2));
  series = hn::MulAdd(z, series, hn::Set(d, 1.0 / 3.0));
  series = hn::MulAdd(z, series, one);
  return hn::MulAdd(hn::Mul(hn::Set(d, 2.885390081777927), y), series, exponent);
}

HWY_INLINE void AddScaled(double share, const double* terms, double* cell) {
  const hn::CappedTag<double, 4> d;
  for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
    hn::StoreU(hn::MulAdd(hn::Set(d, share), hn::Load(d, terms + c), hn::LoadU(d, cell + c)), d,
               cell + c);
  }
}

double SpreadPairs(Values g, Values reduced, Values solution, double lowest, double per_octave,
                   std::span<std::array<double, 4>> sets) {
  assert(reduced.size() == g.size() && solution.size() == g.size() && sets.size() % 2 == 0);
  const std::size_t bins = g.size(), cells = sets.size() / 2;
  // Fixed by: length of an array of whole vectors; bins are added in the same order for any.
  constexpr std::size_t kBlock = 64;
  const Lanes d;
  HWY_ALIGN double place[kBlock];
  HWY_ALIGN double terms[4] = {0.0, 0.0, 0.0, 0.0};
  double unseen = 0.0;
  for (std::size_t begin = 0; begin < bins; begin += kBlock) {
    const std::size_t count = HWY_MIN(kBlock, bins - begin);
    for (std::size_t i = 0; i < kBlock; ++i) place[i] = i < count ? g[begin + i] : 1.0;
    for (std::size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
      const auto octave = hn::Sub(FastLog2(d, hn::Load(d, place + i)), hn::Set(d, lowest));
      const auto inside = hn::Min(hn::Max(hn::Mul(octave, hn::Set(d, per_octave)), hn::Zero(d)),
                                  hn::Set(d, static_cast<double>(cells) - 1.001));
      hn::Store(inside, d, place + i);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t k = begin + i;
      if (!(g[k] > 0.0)) {
        unseen += reduced[k];
        continue;
      }
      const auto cell = static_cast<std::size_t>(static_cast<int>(place[i]));
      const double upper = place[i] - static_cast<double>(static_cast<int>(cell));
      double* target = sets[cell + (k % 2) * cells].data();
      terms[0] = 2.0;
      terms[1] = reduced[k];
      terms[2] = solution[k];
      AddScaled(1.0 - upper, terms, target);
      AddScaled(upper, terms, target + 4);
    }
  }
  return unseen;
}

std::array<double, 4> SumCells(const CellColumns& cells, const CellColumns& values,
                               std::size_t count) {
  assert(count % kCellBlock == 0);
  const Lanes d;
  Lane logarithm = hn::Zero(d), lost = hn::Zero(d), kept = hn::Zero(d), freedom = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Lane m = hn::LoadU(d, cells[0] + i), u = hn::LoadU(d, cells[1] + i);
    const Lane x = hn::LoadU(d, cells[2] + i), keep = hn::LoadU(d, values[1] + i);
    const Lane lose = hn::LoadU(d, values[2] + i);
    logarithm = hn::NegMulAdd(keep, u, hn::MulAdd(hn::LoadU(d, values[0] + i), m, logarithm));
    lost = hn::MulAdd(hn::Mul(lose, lose), u, lost);
    kept = hn::MulAdd(hn::Mul(keep, keep), x, kept);
    freedom = hn::MulAdd(keep, m, freedom);
  }
  const auto total = [d](Lane sum) HWY_ATTR { return hn::GetLane(hn::SumOfLanes(d, sum)); };
  return {total(logarithm), total(lost), total(kept), total(freedom)};
}

const JointKernels* Table() {
  static constexpr JointKernels kTable = {.combine_sides = CombineSides,
                                          .cross_misfit = CrossMisfit,
                                          .scaled_power = ScaledPower,
                                          .evidence_terms = EvidenceTerms,
                                          .expected_power = ExpectedPower,
                                          .apply_posterior = ApplyPosterior,
                                          .through_transfer = ThroughTransfer,
                                          .spread_pairs = SpreadPairs,
                                          .sum_cells = SumCells};
  return &kTable;
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(Table);

const JointKernels& joint_kernels() { return *HWY_DYNAMIC_DISPATCH(Table)(); }

}  // namespace modcal
#endif
