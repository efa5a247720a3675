#include "libcalib/likelihood/kernels/decay_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/likelihood/kernels/decay_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libcalib/likelihood/kernels/planar_complex-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// |κ_odd|², |κ_even|² and χ = conj(κ_odd) κ_even, in bins or at nodes.
struct Weights {
  const double *odd, *even, *mixed_re, *mixed_im;
};
template <std::size_t kCount>
Weights WeightsIn(const double* fields) {
  return {fields, fields + kCount, fields + 2 * kCount, fields + 3 * kCount};
}

void FillWeights(const LikelihoodBlock& block, double* fields, DecayTotals& totals) {
  V odd_sum = hn::Zero(D()), even_sum = hn::Zero(D());
  C mixed_sum = Zero();
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C odd = Load(block.odd, k);
    const C even = Load(block.even, k);
    const C mixed = ConjMul(odd, even);
    hn::Store(Norm(odd), D(), fields + k);
    hn::Store(Norm(even), D(), fields + kBins + k);
    Store(mixed, fields + 2 * kBins + k, fields + 3 * kBins + k);
    odd_sum = hn::Add(odd_sum, Norm(odd));
    even_sum = hn::Add(even_sum, Norm(even));
    mixed_sum = Add(mixed_sum, mixed);
  }
  totals.odd += Sum(odd_sum);
  totals.even += Sum(even_sum);
  totals.mixed += Sum(mixed_sum);
}

HWY_INLINE void AddPowersOf(const LikelihoodMode& mode, const Places& places,
                            const Weights& weights, double* sums) {
  const double* own_weight = mode.even ? weights.even : weights.odd;
  const V sign = Real(mode.even ? 1.0 : -1.0);
  C own = Zero(), own_conj = Zero(), mixed = Zero(), mixed_conj = Zero();
  V square = hn::Zero(D()), square_conj = hn::Zero(D());
  for (std::size_t k = 0; k < places.count; k += hn::Lanes(D())) {
    const Decays decays = DecaysAt(mode.pole, places.Delay(k));
    const V weight = LoadReal(own_weight + k);
    C cross = Load(weights.mixed_re + k, weights.mixed_im + k);
    cross.im = hn::Mul(cross.im, sign);
    own = AddScaled(own, decays.u, weight);
    own_conj = AddScaled(own_conj, decays.u_conj, weight);
    mixed = AddMul(mixed, cross, decays.u);
    mixed_conj = AddMul(mixed_conj, cross, decays.u_conj);
    square = hn::MulAdd(decays.norm, weight, square);
    square_conj = hn::MulAdd(decays.norm_conj, weight, square_conj);
  }
  const V found[kPowerSums] = {own.re,   own.im,        own_conj.re,   own_conj.im, mixed.re,
                               mixed.im, mixed_conj.re, mixed_conj.im, square,      square_conj};
  for (std::size_t i = 0; i < kPowerSums; ++i) AddLanes(sums + i * kSumLanes, found[i]);
}

void AddDecayPowers(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                    const LikelihoodBlock& block, double* sums, DecayTotals& totals) {
  alignas(64) double bins[4 * kBins];
  alignas(64) double nodes[4 * kNodes];
  FillWeights(block, bins, totals);
  if (split.has_far()) Gather(block_nodes(), bins, 4, nodes);
  const auto add = [&](std::span<const std::size_t> list, const Places& places,
                       const Weights& weights) {
    for (const std::size_t n : split.decaying(list)) {
      AddPowersOf(split.modes[n], places, weights, sums + n * kPowerSums * kSumLanes);
    }
  };
  for (std::size_t parity = 0; parity < 2; ++parity) {
    add(split.near[parity], BinsOf(record, block_index), WeightsIn<kBins>(bins));
    add(split.far[parity], NodesOf(record, block_index), WeightsIn<kNodes>(nodes));
  }
}

void CollectDecayPowers(const double* sums, std::span<DecayPowers> powers) {
  for (DecayPowers& mode : powers) {
    double found[kPowerSums];
    for (double& sum : found) {
      sum = SumOfLanes(sums);
      sums += kSumLanes;
    }
    mode = {.own = {found[0], found[1]},
            .own_conj = {found[2], found[3]},
            .mixed = {found[4], found[5]},
            .mixed_conj = {found[6], found[7]},
            .square = found[8],
            .square_conj = found[9]};
  }
}

// `fields`: real and imaginary part of conj(κ_p) v for one parity, one column after the other, each
// `stride` numbers from the next.
template <std::size_t kColumns>
HWY_INLINE void AddProductsOf(const LikelihoodMode& mode, const Places& places,
                              const double* fields, std::size_t stride, double* sums) {
  V by_sum[kColumns], by_difference[kColumns];
  for (std::size_t i = 0; i < kColumns; ++i) by_sum[i] = by_difference[i] = hn::Zero(D());
  for (std::size_t k = 0; k < places.count; k += hn::Lanes(D())) {
    const Decays decays = DecaysAt(mode.pole, places.Delay(k));
    const C sum = Add(decays.u, decays.u_conj);
    const C difference = Sub(decays.u, decays.u_conj);
    for (std::size_t i = 0; i < kColumns; ++i) {
      const C v = Load(fields + i * stride + k, fields + i * stride + places.count + k);
      by_sum[i] = hn::MulAdd(sum.im, v.im, hn::MulAdd(sum.re, v.re, by_sum[i]));
      by_difference[i] =
          hn::NegMulAdd(difference.im, v.re, hn::MulAdd(difference.re, v.im, by_difference[i]));
    }
  }
  for (std::size_t i = 0; i < kColumns; ++i) {
    AddLanes(sums + 2 * i * kSumLanes, by_sum[i]);
    AddLanes(sums + (2 * i + 1) * kSumLanes, by_difference[i]);
  }
}

// Four columns at once: their sums fit the registers.
void AddProductsOfAll(const LikelihoodMode& mode, const Places& places, const double* fields,
                      std::size_t count, double* sums) {
  const std::size_t stride = 4 * places.count;
  for (; count >= 4; count -= 4, fields += 4 * stride, sums += 8 * kSumLanes) {
    AddProductsOf<4>(mode, places, fields, stride, sums);
  }
  if (count == 3) AddProductsOf<3>(mode, places, fields, stride, sums);
  if (count == 2) AddProductsOf<2>(mode, places, fields, stride, sums);
  if (count == 1) AddProductsOf<1>(mode, places, fields, stride, sums);
}

void AddDecayProducts(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                      const LikelihoodBlock& block, const double* columns, std::size_t count,
                      double* sums) {
  alignas(64) double bins[4 * kDecayColumns * kBins];  // a column: odd, then even
  alignas(64) double nodes[4 * kDecayColumns * kNodes];
  for (std::size_t i = 0; i < count; ++i) {
    double* fields = bins + 4 * i * kBins;
    for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
      const C v = LoadColumn(columns + i * kColumnLength, k);
      Store(ConjMul(Load(block.odd, k), v), fields + k, fields + kBins + k);
      Store(ConjMul(Load(block.even, k), v), fields + 2 * kBins + k, fields + 3 * kBins + k);
    }
  }
  if (split.has_far()) Gather(block_nodes(), bins, 4 * count, nodes);
  const auto add = [&](std::span<const std::size_t> list, const Places& places,
                       const double* fields) {
    for (const std::size_t n : split.decaying(list)) {
      AddProductsOfAll(split.modes[n], places, fields, count, sums + n * 2 * count * kSumLanes);
    }
  };
  for (std::size_t parity = 0; parity < 2; ++parity) {
    add(split.near[parity], BinsOf(record, block_index), bins + 2 * parity * kBins);
    add(split.far[parity], NodesOf(record, block_index), nodes + 2 * parity * kNodes);
  }
}

void CollectDecayProducts(const double* sums, std::size_t modes, std::size_t count,
                          double* products) {
  for (std::size_t n = 0; n < modes; ++n) {
    for (std::size_t i = 0; i < count; ++i, sums += 2 * kSumLanes) {
      products[2 * n * count + i] = SumOfLanes(sums);
      products[(2 * n + 1) * count + i] = SumOfLanes(sums + kSumLanes);
    }
  }
}

// Σ a_n U_n + conj(a_n) U'_n of the modes in a list.
HWY_INLINE C DecaySum(const ModeSplit& split, std::span<const std::size_t> list,
                      std::span<const Complex> amplitudes, C delay) {
  C sum = Zero();
  for (const std::size_t n : split.decaying(list)) {
    const Decays decays = DecaysAt(split.modes[n].pole, delay);
    const C amplitude = Set(amplitudes[n]);
    sum = AddConjMul(AddMul(sum, amplitude, decays.u), amplitude, decays.u_conj);
  }
  return sum;
}

// Calls give(k, sum over odd modes, sum over even modes) for the bins of a block.
template <typename Give>
HWY_INLINE void ForDecaySums(const WhitenedRecord& record, std::size_t block_index,
                             const ModeSplit& split, std::span<const Complex> amplitudes,
                             Give give) {
  const Places bins = BinsOf(record, block_index);
  const Places places = NodesOf(record, block_index);
  alignas(64) double nodes[4 * kNodes];
  const bool far = split.has_far();
  for (std::size_t j = 0; far && j < kNodes; j += hn::Lanes(D())) {
    for (std::size_t p = 0; p < 2; ++p) {
      const C sum = DecaySum(split, split.far[p], amplitudes, places.Delay(j));
      Store(sum, nodes + 2 * p * kNodes + j, nodes + (2 * p + 1) * kNodes + j);
    }
  }
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C delay = bins.Delay(k);
    C odd = DecaySum(split, split.near[0], amplitudes, delay);
    C even = DecaySum(split, split.near[1], amplitudes, delay);
    if (far) {
      const Four smooth = Interpolate(block_nodes(), nodes, k);
      odd = Add(odd, C{smooth.a, smooth.b});
      even = Add(even, C{smooth.c, smooth.d});
    }
    give(k, odd, even);
  }
}

void FillDecays(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                std::span<const Complex> amplitudes, LikelihoodBlock& block) {
  ForDecaySums(record, block_index, split, amplitudes, [&](std::size_t k, C odd, C even) {
    Store(odd, block.odd_decay, k);
    Store(even, block.even_decay, k);
  });
}

void SubtractDecays(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                    std::span<const Complex> amplitudes, const LikelihoodBlock& block,
                    double* column) {
  ForDecaySums(record, block_index, split, amplitudes, [&](std::size_t k, C odd, C even) {
    const C sum = AddMul(Mul(Load(block.odd, k), odd), Load(block.even, k), even);
    StoreColumn(Sub(LoadColumn(column, k), sum), column, k);
  });
}

void FillDecayColumns(const WhitenedRecord& record, std::size_t block_index,
                      std::span<const LikelihoodMode> modes, std::span<const std::size_t> list,
                      const LikelihoodBlock& block, double* columns) {
  const Places bins = BinsOf(record, block_index);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C delay = bins.Delay(k);
    const C odd = Load(block.odd, k);
    const C even = Load(block.even, k);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const LikelihoodMode& mode = modes[list[i]];
      const Decays decays = DecaysAt(mode.pole, delay);
      const C factor = mode.even ? even : odd;
      const C difference = Mul(factor, Sub(decays.u, decays.u_conj));
      double* column = columns + 2 * i * kColumnLength;
      StoreColumn(Mul(factor, Add(decays.u, decays.u_conj)), column, k);
      StoreColumn(Make(hn::Neg(difference.im), difference.re), column + kColumnLength, k);
    }
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(AddDecayPowers);
HWY_EXPORT(CollectDecayPowers);
HWY_EXPORT(AddDecayProducts);
HWY_EXPORT(CollectDecayProducts);
HWY_EXPORT(FillDecays);
HWY_EXPORT(SubtractDecays);
HWY_EXPORT(FillDecayColumns);

void add_decay_powers(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                      const LikelihoodBlock& block, double* sums, DecayTotals& totals) {
  HWY_DYNAMIC_DISPATCH(AddDecayPowers)(record, block_index, split, block, sums, totals);
}

void collect_decay_powers(const double* sums, std::span<DecayPowers> powers) {
  HWY_DYNAMIC_DISPATCH(CollectDecayPowers)(sums, powers);
}

void add_decay_products(const WhitenedRecord& record, std::size_t block_index,
                        const ModeSplit& split, const LikelihoodBlock& block, const double* columns,
                        std::size_t count, double* sums) {
  HWY_DYNAMIC_DISPATCH(AddDecayProducts)(record, block_index, split, block, columns, count, sums);
}

void collect_decay_products(const double* sums, std::size_t modes, std::size_t count,
                            double* products) {
  HWY_DYNAMIC_DISPATCH(CollectDecayProducts)(sums, modes, count, products);
}

void fill_decays(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                 std::span<const Complex> amplitudes, LikelihoodBlock& block) {
  HWY_DYNAMIC_DISPATCH(FillDecays)(record, block_index, split, amplitudes, block);
}

void fill_decay_columns(const WhitenedRecord& record, std::size_t block_index,
                        std::span<const LikelihoodMode> modes, std::span<const std::size_t> list,
                        const LikelihoodBlock& block, double* columns) {
  HWY_DYNAMIC_DISPATCH(FillDecayColumns)(record, block_index, modes, list, block, columns);
}

void subtract_decays(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                     std::span<const Complex> amplitudes, const LikelihoodBlock& block,
                     double* column) {
  HWY_DYNAMIC_DISPATCH(SubtractDecays)(record, block_index, split, amplitudes, block, column);
}
}  // namespace modcal
#endif
