#include "libinverse/joint/cell_kernels.hpp"

#include <cassert>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/joint/cell_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<double>;
using Vector = hn::Vec<Lanes>;

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

double SpreadPairs(const double* g, const double* reduced, const double* solution, std::size_t bins,
                   double lowest, double per_octave, double* sets, std::size_t cells) {
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
      double* target = sets + 4 * (cell + (k % 2) * cells);
      terms[0] = 2.0;
      terms[1] = reduced[k];
      terms[2] = solution[k];
      AddScaled(1.0 - upper, terms, target);
      AddScaled(upper, terms, target + 4);
    }
  }
  return unseen;
}

void SumCells(const CellColumns& cells, const CellColumns& values, std::size_t count,
              double* sums) {
  const Lanes d;
  Vector logarithm = hn::Zero(d), lost = hn::Zero(d), kept = hn::Zero(d), freedom = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Vector m = hn::LoadU(d, cells.first + i), u = hn::LoadU(d, cells.second + i);
    const Vector x = hn::LoadU(d, cells.third + i), keep = hn::LoadU(d, values.second + i);
    const Vector lose = hn::LoadU(d, values.third + i);
    logarithm = hn::NegMulAdd(keep, u, hn::MulAdd(hn::LoadU(d, values.first + i), m, logarithm));
    lost = hn::MulAdd(hn::Mul(lose, lose), u, lost);
    kept = hn::MulAdd(hn::Mul(keep, keep), x, kept);
    freedom = hn::MulAdd(keep, m, freedom);
  }
  sums[0] = hn::GetLane(hn::SumOfLanes(d, logarithm));
  sums[1] = hn::GetLane(hn::SumOfLanes(d, lost));
  sums[2] = hn::GetLane(hn::SumOfLanes(d, kept));
  sums[3] = hn::GetLane(hn::SumOfLanes(d, freedom));
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(SumCells);
HWY_EXPORT(SpreadPairs);

double spread_pairs(std::span<const double> g, std::span<const double> reduced,
                    std::span<const double> solution, double lowest, double per_octave,
                    std::span<std::array<double, 4>> sets) {
  assert(reduced.size() == g.size() && solution.size() == g.size() && sets.size() % 2 == 0);
  return HWY_DYNAMIC_DISPATCH(SpreadPairs)(g.data(), reduced.data(), solution.data(), g.size(),
                                           lowest, per_octave, sets[0].data(), sets.size() / 2);
}

void sum_cells(const CellColumns& cells, const CellColumns& values, std::size_t count,
               std::span<double, 4> sums) {
  assert(count % kCellBlock == 0);
  HWY_DYNAMIC_DISPATCH(SumCells)(cells, values, count, sums.data());
}
}  // namespace modcal
#endif
