#include "libcalib/likelihood/decay_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/likelihood/decay_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libcalib/likelihood/planar_complex-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// |κ_odd|², |κ_even|² and χ = conj(κ_odd) κ_even of a block.
struct Weights {
  alignas(64) double odd[kBins];
  alignas(64) double even[kBins];
  LikelihoodBlock::Planar mixed;
};

void FillWeights(const LikelihoodBlock& block, Weights& weights, DecayTotals& totals) {
  V odd_sum = hn::Zero(D()), even_sum = hn::Zero(D());
  C mixed_sum = Zero();
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C odd = Load(block.odd, k);
    const C even = Load(block.even, k);
    const C mixed = ConjMul(odd, even);
    hn::Store(Norm(odd), D(), weights.odd + k);
    hn::Store(Norm(even), D(), weights.even + k);
    Store(mixed, weights.mixed, k);
    odd_sum = hn::Add(odd_sum, Norm(odd));
    even_sum = hn::Add(even_sum, Norm(even));
    mixed_sum = Add(mixed_sum, mixed);
  }
  totals.odd += Sum(odd_sum);
  totals.even += Sum(even_sum);
  totals.mixed += Sum(mixed_sum);
}

HWY_INLINE void AddPowersOf(const LikelihoodMode& mode, const WhitenedRecord& record,
                            std::size_t first, const Weights& weights, DecayPowers& powers) {
  const double* own_weight = mode.even ? weights.even : weights.odd;
  const V sign = Real(mode.even ? 1.0 : -1.0);
  C own = Zero(), own_conj = Zero(), mixed = Zero(), mixed_conj = Zero();
  V square = hn::Zero(D()), square_conj = hn::Zero(D());
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const Decays decays = DecaysAt(mode.pole, Load(record.delay, first + k));
    const V weight = LoadReal(own_weight + k);
    C cross = Load(weights.mixed, k);
    cross.im = hn::Mul(cross.im, sign);
    own = AddScaled(own, decays.u, weight);
    own_conj = AddScaled(own_conj, decays.u_conj, weight);
    mixed = AddMul(mixed, cross, decays.u);
    mixed_conj = AddMul(mixed_conj, cross, decays.u_conj);
    square = hn::MulAdd(Norm(decays.u), weight, square);
    square_conj = hn::MulAdd(Norm(decays.u_conj), weight, square_conj);
  }
  powers.own += Sum(own);
  powers.own_conj += Sum(own_conj);
  powers.mixed += Sum(mixed);
  powers.mixed_conj += Sum(mixed_conj);
  powers.square += Sum(square);
  powers.square_conj += Sum(square_conj);
}

void AddDecayPowers(const WhitenedRecord& record, std::size_t block_index,
                    std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                    std::span<DecayPowers> powers, DecayTotals& totals) {
  Weights weights;
  FillWeights(block, weights, totals);
  for (std::size_t n = 0; n < modes.size(); ++n) {
    AddPowersOf(modes[n], record, block_index * kBins, weights, powers[n]);
  }
}

void AddDecayProducts(const WhitenedRecord& record, std::size_t block_index,
                      std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                      const double* column, double* products) {
  const std::size_t first = block_index * kBins;
  LikelihoodBlock::Planar odd, even;  // conj(κ_p) v
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C v = LoadColumn(column, k);
    Store(ConjMul(Load(block.odd, k), v), odd, k);
    Store(ConjMul(Load(block.even, k), v), even, k);
  }
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const LikelihoodBlock::Planar& data = modes[n].even ? even : odd;
    C sum = Zero(), sum_conj = Zero();
    for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
      const Decays decays = DecaysAt(modes[n].pole, Load(record.delay, first + k));
      const C v = Load(data, k);
      sum = AddConjMul(sum, decays.u, v);
      sum_conj = AddConjMul(sum_conj, decays.u_conj, v);
    }
    products[2 * n] += Sum(hn::Add(sum.re, sum_conj.re));
    products[2 * n + 1] += Sum(hn::Sub(sum.im, sum_conj.im));
  }
}

void FillDecays(const WhitenedRecord& record, std::size_t block_index,
                std::span<const LikelihoodMode> modes, std::span<const Complex> amplitudes,
                LikelihoodBlock& block, double* columns) {
  const std::size_t first = block_index * kBins;
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C delay = Load(record.delay, first + k);
    const C odd = Load(block.odd, k);
    const C even = Load(block.even, k);
    C odd_sum = Zero(), even_sum = Zero();
    for (std::size_t n = 0; n < modes.size(); ++n) {
      const Decays decays = DecaysAt(modes[n].pole, delay);
      const C amplitude = Set(amplitudes[n]);
      C& sum = modes[n].even ? even_sum : odd_sum;
      sum = AddConjMul(AddMul(sum, amplitude, decays.u), amplitude, decays.u_conj);
      if (!columns) continue;
      const C factor = modes[n].even ? even : odd;
      const C difference = Mul(factor, Sub(decays.u, decays.u_conj));
      double* column = columns + 2 * n * kColumnLength;
      StoreColumn(Mul(factor, Add(decays.u, decays.u_conj)), column, k);
      StoreColumn(Make(hn::Neg(difference.im), difference.re), column + kColumnLength, k);
    }
    Store(odd_sum, block.odd_decay, k);
    Store(even_sum, block.even_decay, k);
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(AddDecayPowers);
HWY_EXPORT(AddDecayProducts);
HWY_EXPORT(FillDecays);

void add_decay_powers(const WhitenedRecord& record, std::size_t block_index,
                      std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                      std::span<DecayPowers> powers, DecayTotals& totals) {
  HWY_DYNAMIC_DISPATCH(AddDecayPowers)(record, block_index, modes, block, powers, totals);
}

void add_decay_products(const WhitenedRecord& record, std::size_t block_index,
                        std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                        const double* column, double* products) {
  HWY_DYNAMIC_DISPATCH(AddDecayProducts)(record, block_index, modes, block, column, products);
}

void fill_decays(const WhitenedRecord& record, std::size_t block_index,
                 std::span<const LikelihoodMode> modes, std::span<const Complex> amplitudes,
                 LikelihoodBlock& block, double* columns) {
  HWY_DYNAMIC_DISPATCH(FillDecays)(record, block_index, modes, amplitudes, block, columns);
}
}  // namespace modcal
#endif
