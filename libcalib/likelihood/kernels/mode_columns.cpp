#include "libcalib/likelihood/kernels/mode_columns.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/likelihood/kernels/mode_columns.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libcalib/likelihood/kernels/decay_kernel.hpp"
#include "libcalib/likelihood/kernels/mode_terms-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

HWY_INLINE void AddTo(double* column, std::size_t k, C z) {
  StoreColumn(Add(LoadColumn(column, k), z), column, k);
}

void FillModeColumns(const WhitenedRecord& record, std::size_t block_index,
                     std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                     const ColumnTask& task) {
  const Places places = BinsOf(record, block_index);
  const bool contact = task.contact < task.count;
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const Bins bins = places.BinsFrom(k);
    const C delay = places.Delay(k);
    const C force = Load(block.force, k);
    C by_contact[2] = {Zero(), Zero()};
    for (std::size_t n = 0; n < modes.size(); ++n) {
      const LikelihoodMode& mode = modes[n];
      const ModeTerms terms = TermsOf(mode, n, task, bins, delay);
      const C factor = Load(mode.even ? block.even : block.odd, k);
      C& sum = by_contact[mode.even ? 1 : 0];
      sum = AddScaled(sum, terms.inverse, Real(mode.residue_slope));
      const auto column = [&](const Slopes& slopes) {
        return Mul(factor, AddMul(Mul(delay, slopes.decay), force, slopes.drive));
      };
      const C by_frequency = column(terms.frequency);
      const C by_damping = column(terms.damping);
      for (std::size_t i = task.share_begin[n]; i < task.share_begin[n + 1]; ++i) {
        const ColumnShare& share = task.shares[i];
        double* to = task.jacobian + share.column * kColumnLength;
        if (share.frequency != 0.0) AddTo(to, k, Scale(by_frequency, Real(share.frequency)));
        if (share.damping != 0.0) AddTo(to, k, Scale(by_damping, Real(share.damping)));
        if (share.residue != 0.0) {
          const C drive = Mul(factor, Mul(force, terms.inverse));
          AddTo(to, k, Scale(drive, Real(share.residue * mode.residue_by_stiffness)));
        }
      }
    }
    if (!contact) continue;
    const C sum =
        AddMul(Mul(Load(block.odd, k), by_contact[0]), Load(block.even, k), by_contact[1]);
    AddTo(task.jacobian + task.contact * kColumnLength, k, Mul(force, sum));
  }
}

// Sums over the modes of one parity, a column.
struct SharedSums {
  Slopes of[kSharedColumns];
};
HWY_INLINE void AddShared(const ModeSplit& split, std::span<const std::size_t> list,
                          const ColumnTask& task, const Bins& bins, C delay, SharedSums& sums) {
  const bool contact = task.contact < task.count;
  for (const std::size_t n : list) {
    if (!contact && task.share_begin[n] == task.share_begin[n + 1]) continue;
    const ModeTerms terms = TermsOf(split.modes[n], n, task, bins, delay);
    if (contact) {
      C& sum = sums.of[task.contact].drive;
      sum = AddScaled(sum, terms.inverse, Real(split.modes[n].residue_slope));
    }
    for (std::size_t i = task.share_begin[n]; i < task.share_begin[n + 1]; ++i) {
      const ColumnShare& share = task.shares[i];
      Slopes& sum = sums.of[share.column];
      const auto add = [&](const Slopes& slopes, double part) {
        if (part == 0.0) return;
        sum.drive = AddScaled(sum.drive, slopes.drive, Real(part));
        sum.decay = AddScaled(sum.decay, slopes.decay, Real(part));
      };
      add(terms.frequency, share.frequency);
      add(terms.damping, share.damping);
      if (share.residue != 0.0) {
        const double slope = share.residue * split.modes[n].residue_by_stiffness;
        sum.drive = AddScaled(sum.drive, terms.inverse, Real(slope));
      }
    }
  }
}

// Of the far modes: four numbers a column and parity at the nodes.
void FillSharedNodes(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                     const ColumnTask& task, double* nodes) {
  const Places places = NodesOf(record, block_index);
  for (std::size_t j = 0; j < kNodes; j += hn::Lanes(D())) {
    for (std::size_t p = 0; p < 2; ++p) {
      SharedSums sums;
      for (std::size_t i = 0; i < task.count; ++i) sums.of[i] = {Zero(), Zero()};
      AddShared(split, split.far[p], task, places.BinsFrom(j), places.Delay(j), sums);
      for (std::size_t i = 0; i < task.count; ++i) {
        double* to = nodes + (2 * i + p) * 4 * kNodes + j;
        Store(sums.of[i].drive, to, to + kNodes);
        Store(sums.of[i].decay, to + 2 * kNodes, to + 3 * kNodes);
      }
    }
  }
}

void FillSharedColumns(const WhitenedRecord& record, std::size_t block_index,
                       const ModeSplit& split, const LikelihoodBlock& block,
                       const ColumnTask& task) {
  alignas(64) double nodes[8 * kSharedColumns * kNodes];
  const Places places = BinsOf(record, block_index);
  const bool far = split.has_far();
  if (far) FillSharedNodes(record, block_index, split, task, nodes);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C delay = places.Delay(k);
    const C force = Load(block.force, k);
    for (std::size_t p = 0; p < 2; ++p) {
      SharedSums sums;
      for (std::size_t i = 0; i < task.count; ++i) {
        sums.of[i] = {Zero(), Zero()};
        if (!far) continue;
        const Four smooth = Interpolate(block_nodes(), nodes + (2 * i + p) * 4 * kNodes, k);
        sums.of[i] = {C{smooth.a, smooth.b}, C{smooth.c, smooth.d}};
      }
      AddShared(split, split.near[p], task, places.BinsFrom(k), delay, sums);
      const C factor = Load(p == 1 ? block.even : block.odd, k);
      const C force_factor = Mul(factor, force);
      const C decay_factor = Mul(factor, delay);
      for (std::size_t i = 0; i < task.count; ++i) {
        const C driven = Mul(force_factor, sums.of[i].drive);
        AddTo(task.jacobian + i * kColumnLength, k, AddMul(driven, decay_factor, sums.of[i].decay));
      }
    }
  }
}

// Weights of the products with the residual, one parity: conj(κF) e, then conj(κ z^−1) e.
HWY_INLINE void AddSlopesOf(const LikelihoodMode& mode, const Places& places, const double* fields,
                            bool with_decays, double* sums) {
  V square = hn::Zero(D()), s_square = square, plain = square;
  C decay = Zero();
  for (std::size_t k = 0; k < places.count; k += hn::Lanes(D())) {
    const Bins bins = places.BinsFrom(k);
    const C a = Load(fields + k, fields + places.count + k);
    const C inverse = InverseDenominator(mode, bins);
    const C squared = Mul(inverse, inverse);
    const C s_squared = Mul(squared, bins.s);
    plain = hn::MulAdd(a.im, inverse.im, hn::MulAdd(a.re, inverse.re, plain));
    square = hn::MulAdd(a.im, squared.im, hn::MulAdd(a.re, squared.re, square));
    s_square = hn::MulAdd(a.im, s_squared.im, hn::MulAdd(a.re, s_squared.re, s_square));
    if (!with_decays || !mode.decays) continue;
    const C b = Load(fields + 2 * places.count + k, fields + 3 * places.count + k);
    const Decays decays = DecaysAt(mode.pole, places.Delay(k));
    decay = AddConjMul(decay, Mul(decays.u, decays.u), b);
    decay = AddConjMul(decay, b, Mul(decays.u_conj, decays.u_conj));
  }
  const V found[kSlopeSums] = {plain, square, s_square, decay.re, decay.im};
  for (std::size_t i = 0; i < kSlopeSums; ++i) AddLanes(sums + i * kSumLanes, found[i]);
}

void AddModeSlopes(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                   const LikelihoodBlock& block, bool decays, const double* residual,
                   double* sums) {
  alignas(64) double bins[8 * kBins];
  alignas(64) double nodes[8 * kNodes];
  const Places places = BinsOf(record, block_index);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const C e = LoadColumn(residual, k);
    const C force = Load(block.force, k);
    const C delay = places.Delay(k);
    for (std::size_t p = 0; p < 2; ++p) {
      const C weight = ConjMul(Load(p == 1 ? block.even : block.odd, k), e);
      double* to = bins + 4 * p * kBins + k;
      Store(ConjMul(force, weight), to, to + kBins);
      Store(ConjMul(delay, weight), to + 2 * kBins, to + 3 * kBins);
    }
  }
  if (split.has_far()) Gather(block_nodes(), bins, 8, nodes);
  for (std::size_t p = 0; p < 2; ++p) {
    for (const std::size_t n : split.near[p]) {
      AddSlopesOf(split.modes[n], places, bins + 4 * p * kBins, decays,
                  sums + n * kSlopeSums * kSumLanes);
    }
    for (const std::size_t n : split.far[p]) {
      AddSlopesOf(split.modes[n], NodesOf(record, block_index), nodes + 4 * p * kNodes, decays,
                  sums + n * kSlopeSums * kSumLanes);
    }
  }
}

void CollectModeSlopes(const double* sums, std::span<const LikelihoodMode> modes,
                       const ColumnTask& task, std::span<ModeSlopes> slopes) {
  for (std::size_t n = 0; n < modes.size(); ++n) {
    double found[kSlopeSums];
    for (double& sum : found) {
      sum = SumOfLanes(sums);
      sums += kSumLanes;
    }
    const LikelihoodMode& mode = modes[n];
    const Complex decay(found[3], found[4]);
    const auto turned = [&](std::span<const Complex> by) {
      return by.empty() ? 0.0 : (std::conj(by[n]) * decay).real();
    };
    const double damping = -mode.residue * mode.two_zeta_omega * found[2];
    slopes[n] = {.by_frequency = damping - mode.residue * 2.0 * mode.omega_squared * found[1] +
                                 turned(task.by_frequency),
                 .by_damping = damping + turned(task.by_damping),
                 .by_contact = mode.residue_slope * found[0],
                 .by_residue = mode.residue_by_stiffness * found[0]};
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(FillModeColumns);
HWY_EXPORT(FillSharedColumns);
HWY_EXPORT(AddModeSlopes);
HWY_EXPORT(CollectModeSlopes);

void fill_mode_columns(const WhitenedRecord& record, std::size_t block_index,
                       std::span<const LikelihoodMode> modes, const LikelihoodBlock& block,
                       const ColumnTask& task) {
  HWY_DYNAMIC_DISPATCH(FillModeColumns)(record, block_index, modes, block, task);
}

void fill_shared_columns(const WhitenedRecord& record, std::size_t block_index,
                         const ModeSplit& split, const LikelihoodBlock& block,
                         const ColumnTask& task) {
  HWY_DYNAMIC_DISPATCH(FillSharedColumns)(record, block_index, split, block, task);
}

void add_mode_slopes(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                     const LikelihoodBlock& block, bool decays, const double* residual,
                     double* sums) {
  HWY_DYNAMIC_DISPATCH(AddModeSlopes)(record, block_index, split, block, decays, residual, sums);
}

void collect_mode_slopes(const double* sums, std::span<const LikelihoodMode> modes,
                         const ColumnTask& task, std::span<ModeSlopes> slopes) {
  HWY_DYNAMIC_DISPATCH(CollectModeSlopes)(sums, modes, task, slopes);
}
}  // namespace modcal
#endif
