#include "libcalib/likelihood/likelihood_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/likelihood/likelihood_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libcalib/likelihood/planar_complex-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// s_k and s_k² of the bins k, k + 1, … of a block.
struct Bins {
  C s, s_squared;
};
HWY_INLINE Bins BinsAt(const WhitenedRecord& record, std::size_t k) {
  const V omega =
      hn::Mul(hn::Iota(D(), static_cast<double>(record.first + k)), Real(record.spacing));
  const V sigma = Real(record.sigma);
  return {Make(sigma, omega), Make(hn::NegMulAdd(omega, omega, hn::Mul(sigma, sigma)),
                                   hn::Mul(Real(2.0 * record.sigma), omega))};
}

HWY_INLINE C InverseDenominator(const LikelihoodMode& mode, const Bins& bins) {
  const V damping = Real(mode.two_zeta_omega);
  return Inverse(
      Make(hn::MulAdd(damping, bins.s.re, hn::Add(bins.s_squared.re, Real(mode.omega_squared))),
           hn::MulAdd(damping, bins.s.im, bins.s_squared.im)));
}

// Two sums over the modes: the odd ones and the even ones.
struct Parities {
  C odd, even;
  HWY_INLINE void Add(const LikelihoodMode& mode, C term, V share) {
    C& sum = mode.even ? even : odd;
    sum = AddScaled(sum, term, share);
  }
};

// h_1 and h_2 of the bins.
struct Transfers {
  C left, right;
};
HWY_INLINE Transfers TransfersAt(const WhitenedRecord& record,
                                 std::span<const LikelihoodMode> modes, const Bins& bins) {
  Parities sums{Zero(), Zero()};
  for (const LikelihoodMode& mode : modes) {
    if (mode.residue == 0.0) continue;
    sums.Add(mode, InverseDenominator(mode, bins), Real(mode.residue));
  }
  return {Scale(Add(sums.odd, sums.even), Real(-1.0 / record.deviation[0])),
          Scale(Sub(sums.even, sums.odd), Real(1.0 / record.deviation[1]))};
}

void FillBlock(const WhitenedRecord& record, std::size_t block_index,
               std::span<const LikelihoodMode> modes, const PlanarVector* sensor,
               LikelihoodBlock& block, double* residual) {
  const std::size_t first = block_index * kBins;
  const V per_left = Real(1.0 / record.deviation[0]);
  const V per_right = Real(1.0 / record.deviation[1]);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    auto [left, right] = TransfersAt(record, modes, BinsAt(record, first + k));
    if (sensor) right = Mul(right, Load(*sensor, first + k));
    const V norm = hn::Div(Real(1.0), hn::Add(Norm(left), Norm(right)));
    const V scale = hn::Mul(hn::Sqrt(norm), LoadReal(record.root_weight.data() + first + k));
    const C a = Scale(right, hn::Mul(per_left, scale));
    C b = Scale(left, hn::Mul(per_right, scale));
    if (sensor) b = Mul(b, Load(*sensor, first + k));
    Store(left, block.left, k);
    Store(right, block.right, k);
    Store(Sub(a, b), block.odd, k);
    Store(Add(a, b), block.even, k);
    hn::Store(norm, D(), block.norm + k);
    const C data =
        Sub(Mul(right, Load(record.left, first + k)), Mul(left, Load(record.right, first + k)));
    StoreColumn(Scale(data, scale), residual, k);
  }
}

HWY_INLINE V ScaleAt(const WhitenedRecord& record, const LikelihoodBlock& block, std::size_t first,
                     std::size_t k) {
  return hn::Mul(hn::Sqrt(LoadReal(block.norm + k)),
                 LoadReal(record.root_weight.data() + first + k));
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

HWY_INLINE void AddTo(double* column, std::size_t k, C z, double share) {
  StoreColumn(AddScaled(LoadColumn(column, k), z, Real(share)), column, k);
}

// ∂u_n by ln ω_n and ln ζ_n: c U² z^−1 E' + conj(c) U'² z^−1 conj(E').
struct TransientSlopes {
  C by_frequency, by_damping;
};
HWY_INLINE TransientSlopes TransientSlopesAt(const LikelihoodMode& mode, Complex amplitude,
                                             C delay) {
  const Decays decays = DecaysAt(mode.pole, delay);
  const C part = Mul(Mul(decays.u, decays.u), delay);
  const C conj_part = Mul(Mul(decays.u_conj, decays.u_conj), delay);
  const C frequency = Set(amplitude * mode.pole_by_frequency);
  const C damping = Set(amplitude * mode.pole_by_damping);
  return {AddConjMul(Mul(frequency, part), frequency, conj_part),
          AddConjMul(Mul(damping, part), damping, conj_part)};
}

// Columns of ω_n and ζ_n; inverse: 1/D_n, factor: κ_n.
HWY_INLINE void AddModeColumns(const JacobianTask& task, std::size_t n, const Bins& bins, C delay,
                               C force, C inverse, C factor, std::size_t k) {
  const LikelihoodMode& mode = task.modes[n];
  const C drive = Scale(Mul(force, Mul(inverse, inverse)), Real(-mode.residue));
  const C damping = Scale(bins.s, Real(mode.two_zeta_omega));
  const C stiffness = {hn::Add(damping.re, Real(2.0 * mode.omega_squared)), damping.im};
  C by_frequency = Mul(drive, stiffness);
  C by_damping = Mul(drive, damping);
  if (!task.amplitudes.empty()) {
    const TransientSlopes slopes = TransientSlopesAt(mode, task.amplitudes[n], delay);
    by_frequency = Add(by_frequency, slopes.by_frequency);
    by_damping = Add(by_damping, slopes.by_damping);
  }
  by_frequency = Mul(factor, by_frequency);
  by_damping = Mul(factor, by_damping);
  for (std::size_t i = task.share_begin[n]; i < task.share_begin[n + 1]; ++i) {
    const ColumnShare& share = task.shares[i];
    double* column = task.jacobian + share.column * kColumnLength;
    if (share.frequency != 0.0) AddTo(column, k, by_frequency, share.frequency);
    if (share.damping != 0.0) AddTo(column, k, by_damping, share.damping);
  }
}

// What the end states add to h_1F and to h_2F; decays: the part that the sensor at x = L reads.
struct Transients {
  C left, right, right_decays;
};
HWY_INLINE Transients TransientsAt(const WhitenedRecord& record, const LikelihoodBlock& block,
                                   const JacobianTask& task, std::size_t first, std::size_t k) {
  const V per_left = Real(1.0 / record.deviation[0]);
  const V per_right = Real(1.0 / record.deviation[1]);
  C left = Zero();
  C right = Zero();
  if (!task.amplitudes.empty()) {
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

// Columns of the sensors; left: h_1/|h|, read: what the sensor at x = L reads of the string.
HWY_INLINE void FillSensorColumns(const WhitenedRecord& record, const JacobianTask& task,
                                  const Bins& bins, C left, C read, std::size_t first,
                                  std::size_t k) {
  if (task.sensors[0]) StoreColumn(Mul(left, read), task.sensors[0], k);
  if (task.sensors[1]) {
    StoreColumn(Scale(Mul(left, Mul(bins.s, read)), Real(-1.0)), task.sensors[1], k);
  }
  if (!task.sensors[2]) return;
  const C pole = Inverse(Make(hn::Add(bins.s.re, Real(task.corner)), bins.s.im));
  C slope = Scale(Mul(pole, read), Real(-1.0));
  if (task.plain_by_corner) {
    slope =
        AddScaled(slope, Load(*task.plain_by_corner, first + k), Real(1.0 / record.deviation[1]));
  }
  StoreColumn(Mul(left, slope), task.sensors[2], k);
}

void FillJacobianColumns(const WhitenedRecord& record, std::size_t block_index,
                         const LikelihoodBlock& block, const JacobianTask& task) {
  const std::size_t first = block_index * kBins;
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const Bins bins = BinsAt(record, first + k);
    const C left = Load(block.left, k);
    const C right = Load(block.right, k);
    const C delay = Load(record.delay, first + k);
    const V norm = LoadReal(block.norm + k);
    const V scale = ScaleAt(record, block, first, k);
    const Transients transient = TransientsAt(record, block, task, first, k);
    const C change = Sub(Mul(right, transient.left), Mul(left, transient.right));
    StoreColumn(AddScaled(LoadColumn(task.residual, k), change, scale), task.residual, k);
    const C from_left = Add(Load(record.left, first + k), transient.left);
    const C from_right = Add(Load(record.right, first + k), transient.right);
    const C force = Scale(AddConjMul(ConjMul(left, from_left), right, from_right), norm);
    if (task.force) {
      hn::StoreInterleaved2(force.re, force.im, D(), reinterpret_cast<double*>(task.force + k));
    }
    FillSensorColumns(record, task, bins, Scale(left, scale),
                      Sub(Mul(right, force), transient.right_decays), first, k);
    if (!task.jacobian && !task.contact) continue;
    const C odd = Load(block.odd, k);
    const C even = Load(block.even, k);
    Parities contact{Zero(), Zero()};
    for (std::size_t n = 0; n < task.modes.size(); ++n) {
      const LikelihoodMode& mode = task.modes[n];
      const C inverse = InverseDenominator(mode, bins);
      contact.Add(mode, inverse, Real(mode.residue_slope));
      if (!task.jacobian || task.share_begin[n] == task.share_begin[n + 1]) continue;
      AddModeColumns(task, n, bins, delay, force, inverse, mode.even ? even : odd, k);
    }
    if (!task.contact) continue;
    StoreColumn(Mul(force, AddMul(Mul(odd, contact.odd), even, contact.even)), task.contact, k);
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(FillBlock);
HWY_EXPORT(FillPlainColumn);
HWY_EXPORT(FillJacobianColumns);

void fill_block(const WhitenedRecord& record, std::size_t block_index,
                std::span<const LikelihoodMode> modes, const PlanarVector* sensor,
                LikelihoodBlock& block, double* residual) {
  HWY_DYNAMIC_DISPATCH(FillBlock)(record, block_index, modes, sensor, block, residual);
}

void fill_plain_column(const WhitenedRecord& record, std::size_t block_index,
                       const LikelihoodBlock& block, bool right, const PlanarVector& numbers,
                       double* column) {
  HWY_DYNAMIC_DISPATCH(FillPlainColumn)(record, block_index, block, right, numbers, column);
}

void fill_jacobian_columns(const WhitenedRecord& record, std::size_t block_index,
                           const LikelihoodBlock& block, const JacobianTask& task) {
  HWY_DYNAMIC_DISPATCH(FillJacobianColumns)(record, block_index, block, task);
}
}  // namespace modcal
#endif
