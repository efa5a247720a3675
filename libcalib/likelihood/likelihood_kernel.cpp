#include "libcalib/likelihood/likelihood_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/likelihood/likelihood_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
constexpr std::size_t kBins = WhitenedRecord::kBlock;

// Complex numbers side by side.
struct C {
  V re, im;
};

HWY_INLINE C Make(V re, V im) { return {re, im}; }
HWY_INLINE C Set(Complex z) { return {hn::Set(D(), z.real()), hn::Set(D(), z.imag())}; }
HWY_INLINE C Zero() { return {hn::Zero(D()), hn::Zero(D())}; }
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
HWY_INLINE C Add(C a, C b) { return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)}; }
HWY_INLINE C Sub(C a, C b) { return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)}; }
HWY_INLINE C Scale(C a, V s) { return {hn::Mul(a.re, s), hn::Mul(a.im, s)}; }
HWY_INLINE C Mul(C a, C b) {
  return {hn::NegMulAdd(a.im, b.im, hn::Mul(a.re, b.re)),
          hn::MulAdd(a.im, b.re, hn::Mul(a.re, b.im))};
}
HWY_INLINE C ConjMul(C a, C b) {  // conj(a) b
  return {hn::MulAdd(a.im, b.im, hn::Mul(a.re, b.re)),
          hn::NegMulAdd(a.im, b.re, hn::Mul(a.re, b.im))};
}
HWY_INLINE V Norm(C a) { return hn::MulAdd(a.im, a.im, hn::Mul(a.re, a.re)); }
HWY_INLINE C Inverse(C a) {
  const V scale = hn::Div(hn::Set(D(), 1.0), Norm(a));
  return {hn::Mul(a.re, scale), hn::Neg(hn::Mul(a.im, scale))};
}
HWY_INLINE C OneMinus(C a) { return {hn::Sub(hn::Set(D(), 1.0), a.re), hn::Neg(a.im)}; }

// s_k and s_k² of the bins k, k + 1, … of a block.
struct Bins {
  C s, s_squared;
};
HWY_INLINE Bins BinsAt(const WhitenedRecord& record, std::size_t k) {
  const V omega =
      hn::Mul(hn::Iota(D(), static_cast<double>(record.first + k)), hn::Set(D(), record.spacing));
  const V sigma = hn::Set(D(), record.sigma);
  return {Make(sigma, omega), Make(hn::NegMulAdd(omega, omega, hn::Mul(sigma, sigma)),
                                   hn::Mul(hn::Set(D(), 2.0 * record.sigma), omega))};
}

HWY_INLINE C InverseDenominator(const LikelihoodMode& mode, const Bins& bins) {
  const V damping = hn::Set(D(), mode.two_zeta_omega);
  return Inverse(Make(
      hn::MulAdd(damping, bins.s.re, hn::Add(bins.s_squared.re, hn::Set(D(), mode.omega_squared))),
      hn::MulAdd(damping, bins.s.im, bins.s_squared.im)));
}

HWY_INLINE void StoreColumn(C z, double* column, std::size_t k) {
  Store(z, column + k, column + kBins + k);
}

void FillStateColumns(const WhitenedRecord& record, std::size_t block_index,
                      std::span<const LikelihoodMode> modes, LikelihoodBlock& block, double* state,
                      double* offsets, double* residual) {
  const std::size_t first = block_index * kBins;
  const V per_left = hn::Set(D(), 1.0 / record.deviation[0]);
  const V per_right = hn::Set(D(), 1.0 / record.deviation[1]);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const Bins bins = BinsAt(record, first + k);
    C odd_sum = Zero();
    C even_sum = Zero();
    for (const LikelihoodMode& mode : modes) {
      if (mode.residue == 0.0) continue;
      const C term = Scale(InverseDenominator(mode, bins), hn::Set(D(), mode.residue));
      if (mode.even) {
        even_sum = Add(even_sum, term);
      } else {
        odd_sum = Add(odd_sum, term);
      }
    }
    const C left = Scale(Add(odd_sum, even_sum), hn::Neg(per_left));
    const C right = Scale(Sub(even_sum, odd_sum), per_right);
    const V norm = hn::Div(hn::Set(D(), 1.0), hn::Add(Norm(left), Norm(right)));
    const V scale = hn::Mul(hn::Sqrt(norm), hn::Load(D(), record.root_weight.data() + first + k));
    const C a = Scale(right, hn::Mul(per_left, scale));
    const C b = Scale(left, hn::Mul(per_right, scale));
    const C odd = Sub(a, b);
    const C even = Add(a, b);
    Store(left, block.left.re + k, block.left.im + k);
    Store(right, block.right.re + k, block.right.im + k);
    Store(odd, block.odd.re + k, block.odd.im + k);
    Store(even, block.even.re + k, block.even.im + k);
    hn::Store(norm, D(), block.norm + k);
    const C data =
        Sub(Mul(right, Load(record.left, first + k)), Mul(left, Load(record.right, first + k)));
    StoreColumn(Scale(data, scale), residual, k);
    const C offset = Load(record.offset, first + k);
    if (offsets) {
      StoreColumn(Mul(a, offset), offsets, k);
      StoreColumn(Mul(b, offset), offsets + kColumnLength, k);
    }
    if (!state) continue;
    const C delay = Load(record.delay, first + k);
    double* column = state;
    for (const LikelihoodMode& mode : modes) {
      const C factor = mode.even ? even : odd;
      const C u = Inverse(OneMinus(Mul(Set(mode.pole), delay)));
      const C u_conj = Inverse(OneMinus(ConjMul(Set(mode.pole), delay)));
      const C sum = Add(u, u_conj);
      const C difference = Sub(u, u_conj);
      StoreColumn(Mul(factor, sum), column, k);
      StoreColumn(Mul(factor, Make(hn::Neg(difference.im), difference.re)), column + kColumnLength,
                  k);
      column += 2 * kColumnLength;
    }
  }
}

HWY_INLINE void AddTo(double* column, std::size_t k, C z, double share) {
  const V factor = hn::Set(D(), share);
  hn::Store(hn::MulAdd(z.re, factor, hn::Load(D(), column + k)), D(), column + k);
  double* imag = column + kBins + k;
  hn::Store(hn::MulAdd(z.im, factor, hn::Load(D(), imag)), D(), imag);
}

// Transients Σ c_n U_n + conj(c_n) U'_n of the odd and the even modes.
HWY_INLINE void SumTransients(const JacobianTask& task, C delay, C& odd, C& even) {
  odd = Zero();
  even = Zero();
  for (std::size_t n = 0; n < task.amplitudes.size(); ++n) {
    const LikelihoodMode& mode = task.modes[n];
    const C amplitude = Set(task.amplitudes[n]);
    const C u = Inverse(OneMinus(Mul(Set(mode.pole), delay)));
    const C u_conj = Inverse(OneMinus(ConjMul(Set(mode.pole), delay)));
    const C term = Add(Mul(amplitude, u), ConjMul(amplitude, u_conj));
    if (mode.even) {
      even = Add(even, term);
    } else {
      odd = Add(odd, term);
    }
  }
}

// c U² z^−1 E' + conj(c) U'² z^−1 conj(E').
HWY_INLINE C TransientSlope(Complex amplitude, Complex pole_slope, C u_part, C u_conj_part) {
  const C factor = Set(amplitude * pole_slope);
  return Add(Mul(factor, u_part), ConjMul(factor, u_conj_part));
}

HWY_INLINE void AddModeColumns(const JacobianTask& task, std::size_t n, const Bins& bins, C delay,
                               C force, C factor, std::size_t k) {
  const std::size_t begin = task.share_begin[n];
  const std::size_t end = task.share_begin[n + 1];
  if (begin == end) return;
  const LikelihoodMode& mode = task.modes[n];
  const C inverse = InverseDenominator(mode, bins);
  const C drive = Scale(Mul(force, Mul(inverse, inverse)), hn::Set(D(), -mode.residue));
  const C damping = Scale(bins.s, hn::Set(D(), mode.two_zeta_omega));
  const C stiffness = {hn::Add(damping.re, hn::Set(D(), 2.0 * mode.omega_squared)), damping.im};
  C by_frequency = Mul(drive, stiffness);
  C by_damping = Mul(drive, damping);
  if (!task.amplitudes.empty()) {
    const C u = Inverse(OneMinus(Mul(Set(mode.pole), delay)));
    const C u_conj = Inverse(OneMinus(ConjMul(Set(mode.pole), delay)));
    const C part = Mul(Mul(u, u), delay);
    const C conj_part = Mul(Mul(u_conj, u_conj), delay);
    const Complex c = task.amplitudes[n];
    by_frequency = Add(by_frequency, TransientSlope(c, mode.pole_by_frequency, part, conj_part));
    by_damping = Add(by_damping, TransientSlope(c, mode.pole_by_damping, part, conj_part));
  }
  by_frequency = Mul(factor, by_frequency);
  by_damping = Mul(factor, by_damping);
  for (std::size_t i = begin; i < end; ++i) {
    const ColumnShare& share = task.shares[i];
    double* column = task.jacobian + share.column * kColumnLength;
    if (share.frequency != 0.0) AddTo(column, k, by_frequency, share.frequency);
    if (share.damping != 0.0) AddTo(column, k, by_damping, share.damping);
  }
}

HWY_INLINE C ContactColumn(const JacobianTask& task, const Bins& bins, C odd, C even) {
  C odd_sum = Zero();
  C even_sum = Zero();
  for (const LikelihoodMode& mode : task.modes) {
    const C term = Scale(InverseDenominator(mode, bins), hn::Set(D(), mode.residue_slope));
    if (mode.even) {
      even_sum = Add(even_sum, term);
    } else {
      odd_sum = Add(odd_sum, term);
    }
  }
  return Add(Mul(odd, odd_sum), Mul(even, even_sum));
}

void FillJacobianColumns(const WhitenedRecord& record, std::size_t block_index,
                         const LikelihoodBlock& block, const JacobianTask& task) {
  const std::size_t first = block_index * kBins;
  const V per_left = hn::Set(D(), 1.0 / record.deviation[0]);
  const V per_right = hn::Set(D(), 1.0 / record.deviation[1]);
  for (std::size_t k = 0; k < kBins; k += hn::Lanes(D())) {
    const Bins bins = BinsAt(record, first + k);
    const C left = Load(block.left, k);
    const C right = Load(block.right, k);
    const C odd = Load(block.odd, k);
    const C even = Load(block.even, k);
    const C delay = Load(record.delay, first + k);
    const C offset = Load(record.offset, first + k);
    C odd_transient, even_transient;
    SumTransients(task, delay, odd_transient, even_transient);
    const C left_offset = Scale(offset, hn::Set(D(), task.offset[0]));
    const C right_offset = Scale(offset, hn::Set(D(), task.offset[1]));
    const V root_weight = hn::Load(D(), record.root_weight.data() + first + k);
    const V scale = hn::Mul(hn::Sqrt(hn::Load(D(), block.norm + k)), root_weight);
    C residual = Load(task.residual + k, task.residual + kBins + k);
    residual = Add(residual, Add(Mul(odd, odd_transient), Mul(even, even_transient)));
    residual = Add(residual, Scale(Add(Mul(right, Scale(left_offset, per_left)),
                                       Mul(left, Scale(right_offset, per_right))),
                                   scale));
    StoreColumn(residual, task.residual, k);
    const C from_left = Add(Load(record.left, first + k),
                            Scale(Add(Add(odd_transient, even_transient), left_offset), per_left));
    const C from_right =
        Sub(Load(record.right, first + k),
            Scale(Add(Sub(even_transient, odd_transient), right_offset), per_right));
    const C force = Scale(Add(ConjMul(left, from_left), ConjMul(right, from_right)),
                          hn::Load(D(), block.norm + k));
    if (task.force) {
      hn::StoreInterleaved2(force.re, force.im, D(), reinterpret_cast<double*>(task.force + k));
    }
    if (task.contact) {
      StoreColumn(Mul(force, ContactColumn(task, bins, odd, even)), task.contact, k);
    }
    if (!task.jacobian) continue;
    for (std::size_t n = 0; n < task.modes.size(); ++n) {
      AddModeColumns(task, n, bins, delay, force, task.modes[n].even ? even : odd, k);
    }
  }
}

HWY_INLINE double Sum(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

// Products of four columns with four: sixteen accumulators hide the latency of multiply-add.
HWY_INLINE void AddTile(const double* a, const double* b, double* out, std::size_t stride) {
  V s00 = hn::Zero(D()), s01 = s00, s02 = s00, s03 = s00, s10 = s00, s11 = s00, s12 = s00,
    s13 = s00, s20 = s00, s21 = s00, s22 = s00, s23 = s00, s30 = s00, s31 = s00, s32 = s00,
    s33 = s00;
  constexpr std::size_t kL = kColumnLength;
  for (std::size_t k = 0; k < kL; k += hn::Lanes(D())) {
    const V b0 = hn::Load(D(), b + k), b1 = hn::Load(D(), b + kL + k),
            b2 = hn::Load(D(), b + 2 * kL + k), b3 = hn::Load(D(), b + 3 * kL + k);
    const V a0 = hn::Load(D(), a + k);
    s00 = hn::MulAdd(a0, b0, s00), s01 = hn::MulAdd(a0, b1, s01);
    s02 = hn::MulAdd(a0, b2, s02), s03 = hn::MulAdd(a0, b3, s03);
    const V a1 = hn::Load(D(), a + kL + k);
    s10 = hn::MulAdd(a1, b0, s10), s11 = hn::MulAdd(a1, b1, s11);
    s12 = hn::MulAdd(a1, b2, s12), s13 = hn::MulAdd(a1, b3, s13);
    const V a2 = hn::Load(D(), a + 2 * kL + k);
    s20 = hn::MulAdd(a2, b0, s20), s21 = hn::MulAdd(a2, b1, s21);
    s22 = hn::MulAdd(a2, b2, s22), s23 = hn::MulAdd(a2, b3, s23);
    const V a3 = hn::Load(D(), a + 3 * kL + k);
    s30 = hn::MulAdd(a3, b0, s30), s31 = hn::MulAdd(a3, b1, s31);
    s32 = hn::MulAdd(a3, b2, s32), s33 = hn::MulAdd(a3, b3, s33);
  }
  out[0] += Sum(s00), out[1] += Sum(s01), out[2] += Sum(s02), out[3] += Sum(s03);
  out += stride;
  out[0] += Sum(s10), out[1] += Sum(s11), out[2] += Sum(s12), out[3] += Sum(s13);
  out += stride;
  out[0] += Sum(s20), out[1] += Sum(s21), out[2] += Sum(s22), out[3] += Sum(s23);
  out += stride;
  out[0] += Sum(s30), out[1] += Sum(s31), out[2] += Sum(s32), out[3] += Sum(s33);
}

HWY_INLINE double Product(const double* a, const double* b) {
  V sum = hn::Zero(D());
  for (std::size_t k = 0; k < kColumnLength; k += hn::Lanes(D())) {
    sum = hn::MulAdd(hn::Load(D(), a + k), hn::Load(D(), b + k), sum);
  }
  return Sum(sum);
}

void AddProducts(const double* a, std::size_t a_count, const double* b, std::size_t b_count,
                 bool lower, double* out, std::size_t stride) {
  constexpr std::size_t kTile = 4;
  for (std::size_t i = 0; i < a_count; i += kTile) {
    for (std::size_t j = 0; j < b_count; j += kTile) {
      if (lower && j >= i + kTile) break;
      double* target = out + i * stride + j;
      if (i + kTile <= a_count && j + kTile <= b_count) {
        AddTile(a + i * kColumnLength, b + j * kColumnLength, target, stride);
        continue;
      }
      for (std::size_t p = i; p < a_count && p < i + kTile; ++p) {
        for (std::size_t q = j; q < b_count && q < j + kTile; ++q) {
          out[p * stride + q] += Product(a + p * kColumnLength, b + q * kColumnLength);
        }
      }
    }
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(FillStateColumns);
HWY_EXPORT(FillJacobianColumns);
HWY_EXPORT(AddProducts);

void fill_state_columns(const WhitenedRecord& record, std::size_t block_index,
                        std::span<const LikelihoodMode> modes, LikelihoodBlock& block,
                        double* state, double* offsets, double* residual) {
  HWY_DYNAMIC_DISPATCH(FillStateColumns)
  (record, block_index, modes, block, state, offsets, residual);
}

void fill_jacobian_columns(const WhitenedRecord& record, std::size_t block_index,
                           const LikelihoodBlock& block, const JacobianTask& task) {
  HWY_DYNAMIC_DISPATCH(FillJacobianColumns)(record, block_index, block, task);
}

void add_products(const double* a, std::size_t a_count, const double* b, std::size_t b_count,
                  bool lower, double* out, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(AddProducts)(a, a_count, b, b_count, lower, out, stride);
}
}  // namespace modcal
#endif
