#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/likelihood/kernels/likelihood_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libcalib/likelihood/kernels/planar_complex-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// Two sums over the modes: the odd ones and the even ones.
struct Parities {
  C odd, even;
};

// h_1 and h_2 of the bins.
struct Transfers {
  C left, right;
};
HWY_INLINE Transfers TransfersOf(const WhitenedRecord& record, const Parities& sums) {
  return {Scale(Add(sums.odd, sums.even), Real(-1.0 / record.deviation[0])),
          Scale(Sub(sums.even, sums.odd), Real(1.0 / record.deviation[1]))};
}

HWY_INLINE C ReceptanceSum(const ModeSplit& split, std::span<const std::size_t> list,
                           const Bins& bins) {
  C sum = Zero();
  for (const std::size_t n : list) {
    const LikelihoodMode& mode = split.modes[n];
    if (mode.residue == 0.0) continue;
    sum = AddScaled(sum, InverseDenominator(mode, bins), Real(mode.residue));
  }
  return sum;
}

HWY_INLINE V ResidualVarianceAt(const WhitenedRecord& record, C left, C right, std::size_t bin) {
  if (record.white()) return hn::Add(Norm(left), Norm(right));
  return ResidualVariance(left, right, LoadReal(record.left_noise.data() + bin),
                          LoadReal(record.right_noise.data() + bin),
                          LoadReal(record.mixed_noise.data() + bin));
}

// Best estimate of F under that noise, from what both ends read of it; norm: 1/ResidualVarianceAt.
HWY_INLINE C ForceOf(const WhitenedRecord& record, C left, C right, C from_left, C from_right,
                     V norm, std::size_t bin) {
  if (!record.white()) {
    const V mixed = LoadReal(record.mixed_noise.data() + bin);
    const C own_left = Scale(left, LoadReal(record.right_noise.data() + bin));
    const C own_right = Scale(right, LoadReal(record.left_noise.data() + bin));
    const C other = Scale(left, mixed);
    left = Sub(own_left, Scale(right, mixed));
    right = Sub(own_right, other);
  }
  return Scale(AddConjMul(ConjMul(left, from_left), right, from_right), norm);
}

void FillBlock(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
               const PlanarVector* sensor, LikelihoodBlock& block) {
  const std::size_t first = block_index * kBins;
  const Places places = BinsOf(record, block_index);
  const Places far_places = NodesOf(record, block_index);
  alignas(64) double nodes[4 * kNodes];
  const bool far = split.has_far();
  for (std::size_t j = 0; far && j < kNodes; j += hn::Lanes(D())) {
    for (std::size_t p = 0; p < 2; ++p) {
      const C sum = ReceptanceSum(split, split.far[p], far_places.BinsFrom(j));
      Store(sum, nodes + 2 * p * kNodes + j, nodes + (2 * p + 1) * kNodes + j);
    }
  }
  const V per_left = Real(1.0 / record.deviation[0]);
  const V per_right = Real(1.0 / record.deviation[1]);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const Bins bins = places.BinsFrom(k);
    Parities sums{ReceptanceSum(split, split.near[0], bins),
                  ReceptanceSum(split, split.near[1], bins)};
    if (far) {
      const Four smooth = Interpolate(block_nodes(), nodes, k);
      sums = {Add(sums.odd, C{smooth.a, smooth.b}), Add(sums.even, C{smooth.c, smooth.d})};
    }
    auto [left, right] = TransfersOf(record, sums);
    if (sensor) right = Mul(right, Load(*sensor, first + k));
    const V norm = hn::Div(Real(1.0), ResidualVarianceAt(record, left, right, first + k));
    const V scale = hn::Mul(hn::Sqrt(norm), LoadReal(record.root_weight.data() + first + k));
    const C a = Scale(right, hn::Mul(per_left, scale));
    C b = Scale(left, hn::Mul(per_right, scale));
    if (sensor) b = Mul(b, Load(*sensor, first + k));
    Store(left, block.left, k);
    Store(right, block.right, k);
    Store(Sub(a, b), block.odd, k);
    Store(Add(a, b), block.even, k);
    hn::Store(norm, D(), block.norm + k);
  }
}

HWY_INLINE V ScaleAt(const WhitenedRecord& record, const LikelihoodBlock& block, std::size_t first,
                     std::size_t k) {
  return hn::Mul(hn::Sqrt(LoadReal(block.norm + k)),
                 LoadReal(record.root_weight.data() + first + k));
}

void FillResidual(const WhitenedRecord& record, std::size_t block_index,
                  const LikelihoodBlock& block, double* residual) {
  const std::size_t first = block_index * kBins;
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C data = Sub(Mul(Load(block.right, k), Load(record.left, first + k)),
                       Mul(Load(block.left, k), Load(record.right, first + k)));
    StoreColumn(Scale(data, ScaleAt(record, block, first, k)), residual, k);
  }
}

void FillPlainColumn(const WhitenedRecord& record, std::size_t block_index,
                     const LikelihoodBlock& block, bool right, const PlanarVector& numbers,
                     double* column) {
  const std::size_t first = block_index * kBins;
  const V per_deviation = Real(1.0 / record.deviation[right ? 1 : 0]);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C other = Load(right ? block.left : block.right, k);
    const V scale = hn::Mul(ScaleAt(record, block, first, k), per_deviation);
    StoreColumn(Scale(Mul(other, Load(numbers, first + k)), scale), column, k);
  }
}

void FillSignalColumn(const WhitenedRecord& record, std::size_t block_index,
                      const LikelihoodBlock& block, const SignalColumn& signal, double* column) {
  const std::size_t first = block_index * kBins;
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    C change = Zero();
    if (signal.right.size() > 0) {
      change = Mul(Load(block.left, k), Load(signal.right, first + k));
    }
    if (signal.left.size() > 0) {
      change = Sub(change, Mul(Load(block.right, k), Load(signal.left, first + k)));
    }
    StoreColumn(Scale(change, ScaleAt(record, block, first, k)), column, k);
  }
}

// What the end states add to h_1F and to h_2F; decays: the part that the sensor at x = L reads.
struct Transients {
  C left, right, right_decays;
};
HWY_INLINE Transients TransientsAt(const WhitenedRecord& record, const LikelihoodBlock& block,
                                   const ResidualTask& task, std::size_t first, std::size_t k) {
  const V per_left = Real(1.0 / record.deviation[0]);
  const V per_right = Real(1.0 / record.deviation[1]);
  C left = Zero();
  C right = Zero();
  if (task.decays) {
    const C odd = Load(block.odd_decay, k);
    const C even = Load(block.even_decay, k);
    left = Scale(Add(odd, even), per_left);
    right = Scale(Sub(odd, even), per_right);
    if (task.sensor) right = Mul(right, Load(*task.sensor, first + k));
  }
  const C decays = right;
  if (task.plain[0]) left = AddScaled(left, Load(*task.plain[0], first + k), per_left);
  if (task.plain[1]) {
    right = Sub(right, Scale(Load(*task.plain[1], first + k), per_right));
  }
  return {left, right, decays};
}

// Columns of the sensor at x = L; left: h_1/|h|, read: what it reads of the string.
HWY_INLINE void FillSensorColumns(const WhitenedRecord& record, const ResidualTask& task, C left,
                                  C read, std::size_t first, std::size_t k) {
  for (const SensorColumn& sensor : task.columns) {
    if (!sensor.column) continue;
    C slope = Mul(Load(*sensor.slope, first + k), read);
    if (sensor.plain) {
      slope = AddScaled(slope, Load(*sensor.plain, first + k), Real(1.0 / record.deviation[1]));
    }
    StoreColumn(Mul(left, slope), sensor.column, k);
  }
}

void FinishResidual(const WhitenedRecord& record, std::size_t block_index, const ResidualTask& task,
                    LikelihoodBlock& block) {
  const std::size_t first = block_index * kBins;
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C left = Load(block.left, k);
    const C right = Load(block.right, k);
    const V norm = LoadReal(block.norm + k);
    const V scale = ScaleAt(record, block, first, k);
    const Transients transient = TransientsAt(record, block, task, first, k);
    const C change = Sub(Mul(right, transient.left), Mul(left, transient.right));
    StoreColumn(AddScaled(LoadColumn(task.residual, k), change, scale), task.residual, k);
    const C from_left = Add(Load(record.left, first + k), transient.left);
    const C from_right = Add(Load(record.right, first + k), transient.right);
    const C force = ForceOf(record, left, right, from_left, from_right, norm, first + k);
    Store(force, block.force, k);
    FillSensorColumns(record, task, Scale(left, scale),
                      Sub(Mul(right, force), transient.right_decays), first, k);
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(FillBlock);
HWY_EXPORT(FillResidual);
HWY_EXPORT(FillPlainColumn);
HWY_EXPORT(FillSignalColumn);
HWY_EXPORT(FinishResidual);

void fill_block(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                const PlanarVector* sensor, LikelihoodBlock& block) {
  HWY_DYNAMIC_DISPATCH(FillBlock)(record, block_index, split, sensor, block);
}

void fill_residual(const WhitenedRecord& record, std::size_t block_index,
                   const LikelihoodBlock& block, double* residual) {
  HWY_DYNAMIC_DISPATCH(FillResidual)(record, block_index, block, residual);
}

void fill_plain_column(const WhitenedRecord& record, std::size_t block_index,
                       const LikelihoodBlock& block, bool right, const PlanarVector& numbers,
                       double* column) {
  HWY_DYNAMIC_DISPATCH(FillPlainColumn)(record, block_index, block, right, numbers, column);
}

void fill_signal_column(const WhitenedRecord& record, std::size_t block_index,
                        const LikelihoodBlock& block, const SignalColumn& signal, double* column) {
  HWY_DYNAMIC_DISPATCH(FillSignalColumn)(record, block_index, block, signal, column);
}

void finish_residual(const WhitenedRecord& record, std::size_t block_index,
                     const ResidualTask& task, LikelihoodBlock& block) {
  HWY_DYNAMIC_DISPATCH(FinishResidual)(record, block_index, task, block);
}
}  // namespace modcal
#endif
