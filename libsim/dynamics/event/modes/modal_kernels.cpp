#include "libsim/dynamics/event/modes/modal_kernels.hpp"

#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/event/modes/modal_kernels.cpp"
// Highway asks for this order.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::event::HWY_NAMESPACE {
using namespace modcal::HWY_NAMESPACE;

// out = factor ∘ state with the factor at i from factor_at(i); `rows`, where there are any, are
// summed over the new state.
template <std::size_t kRows, typename FactorAt>
HWY_INLINE SumAndRate AdvanceSeen(const FactorAt& factor_at, const PlanarVector& pole,
                                  const PlanarVector& state, const PlanarRows& rows, double* seen,
                                  PlanarVector& out) {
  const Tag d;
  const Source poles(pole), states(state);
  const Rows weights(rows);
  const Target to(out);
  const std::size_t size = state.size();
  Vector sum = hn::Zero(d), rate = hn::Zero(d);
  Vector row[kRows + 1];
  for (std::size_t r = 0; r < kRows; ++r) row[r] = hn::Zero(d);
  for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
    const ComplexVector mu = poles[i];
    const ComplexVector next = Times(factor_at(i, mu), states[i]);
    to.Set(i, next);
    sum = hn::Add(sum, next.re);
    rate = hn::NegMulAdd(mu.im, next.im, hn::MulAdd(mu.re, next.re, rate));
    for (std::size_t r = 0; r < kRows; ++r) {
      row[r] = hn::MulAdd(weights.Re(r, i), next.re, row[r]);
      row[r] = hn::NegMulAdd(weights.Im(r, i), next.im, row[r]);
    }
  }
  for (std::size_t r = 0; r < kRows; ++r) seen[r] = Total(row[r]);
  return {Total(sum), Total(rate)};
}

SumAndRate Advance(const PlanarVector& factor, const PlanarVector& pole, const PlanarVector& state,
                   PlanarVector& out, const PlanarRows& rows, std::span<double> seen) {
  const Source factors(factor);
  const auto at = [factors](std::size_t i, ComplexVector /*pole*/) HWY_ATTR { return factors[i]; };
  if (seen.size() == 1) return AdvanceSeen<1>(at, pole, state, rows, seen.data(), out);
  if (seen.size() == 3) return AdvanceSeen<3>(at, pole, state, rows, seen.data(), out);
  assert(seen.empty());
  return AdvanceSeen<0>(at, pole, state, rows, nullptr, out);
}

SumAndRate AdvanceBy(double time, const PlanarVector& pole, const PlanarVector& state,
                     PlanarVector& out) {
  const Tag d;
  const auto t = hn::Set(d, time);
  const auto at = [&](std::size_t /*i*/, ComplexVector mu) HWY_ATTR {
    const auto modulus = hn::Exp(d, hn::Mul(mu.re, t));
    const auto phase = hn::Mul(mu.im, t);
    return ComplexVector{hn::Mul(modulus, hn::Cos(d, phase)), hn::Mul(modulus, hn::Sin(d, phase))};
  };
  return AdvanceSeen<0>(at, pole, state, {}, nullptr, out);
}

// kRows sums side by side: as many chains as the latency of a multiply-add needs.
template <std::size_t kRows>
HWY_INLINE void ProductsOfRows(const PlanarRows& rows, std::size_t first, const PlanarVector& state,
                               double* out) {
  const Tag d;
  const Source states(state);
  const Rows weights(rows, first);
  const std::size_t size = state.size();
  Vector sum[kRows];
  for (std::size_t r = 0; r < kRows; ++r) sum[r] = hn::Zero(d);
  for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
    const ComplexVector z = states[i];
    for (std::size_t r = 0; r < kRows; ++r) {
      sum[r] = hn::MulAdd(weights.Re(r, i), z.re, sum[r]);
      sum[r] = hn::NegMulAdd(weights.Im(r, i), z.im, sum[r]);
    }
  }
  // Always the same order of additions: a row's value does not depend on what else is asked for.
  for (std::size_t r = 0; r < kRows; r += 4) {
    const auto at = [&](std::size_t i) { return i < kRows ? sum[i] : hn::Zero(d); };
    double totals[4];
    FourTotals(at(r), at(r + 1), at(r + 2), at(r + 3), totals);
    for (std::size_t i = r; i < kRows && i < r + 4; ++i) out[i] = totals[i - r];
  }
}

void RealProducts(const PlanarRows& rows, const PlanarVector& state, std::span<double> out) {
  std::size_t r = 0;
  for (; r + 8 <= out.size(); r += 8) ProductsOfRows<8>(rows, r, state, &out[r]);
  for (; r + 4 <= out.size(); r += 4) ProductsOfRows<4>(rows, r, state, &out[r]);
  for (; r + 2 <= out.size(); r += 2) ProductsOfRows<2>(rows, r, state, &out[r]);
  if (r < out.size()) ProductsOfRows<1>(rows, r, state, &out[r]);
}

double WeightedSize(const AlignedVector& weight, const PlanarVector& state) {
  const Tag d;
  const Source states(state);
  const std::size_t size = state.size();
  Vector sum = hn::Zero(d);
  for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
    const ComplexVector z = states[i];
    sum = hn::MulAdd(hn::Load(d, &weight[i]), hn::Add(hn::Abs(z.re), hn::Abs(z.im)), sum);
  }
  return Total(sum);
}

template <std::size_t kForces>
HWY_INLINE void AdvanceDrivenBy(const PlanarVector& factor, const PlanarRows& response,
                                const double* forces, PlanarVector& state) {
  const Tag d;
  const Source factors(factor), states(state);
  const Rows responses(response);
  const Target to(state);
  const std::size_t size = state.size();
  Vector force[kForces];
  for (std::size_t j = 0; j < kForces; ++j) force[j] = hn::Set(d, forces[j]);
  for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
    ComplexVector z = Times(factors[i], states[i]);
    for (std::size_t j = 0; j < kForces; ++j) {
      z.re = hn::MulAdd(responses.Re(j, i), force[j], z.re);
      z.im = hn::MulAdd(responses.Im(j, i), force[j], z.im);
    }
    to.Set(i, z);
  }
}

void AdvanceDriven(const PlanarVector& factor, const PlanarRows& response,
                   std::span<const double> forces, PlanarVector& state) {
  const double* f = forces.data();
  if (forces.size() == 2) return AdvanceDrivenBy<2>(factor, response, f, state);
  if (forces.size() == 3) return AdvanceDrivenBy<3>(factor, response, f, state);
  if (forces.size() == 4) return AdvanceDrivenBy<4>(factor, response, f, state);
  return AdvanceDrivenBy<5>(factor, response, f, state);
}

void AdvanceDrivenFor(double time, double largest, const PlanarVector& pole,
                      const AlignedVector& drive, std::span<const double> weights,
                      PlanarVector& state) {
  // Fixed by: length of an array; where |x| ≤ 1.3 a series is done after 22 terms.
  constexpr int kMostTerms = 32;
  const Tag d;
  const std::size_t order = weights.size();
  // coefficient[p] = 1/(p + order)!, as many as the largest |x| needs for rounding.
  double coefficient[kMostTerms];
  double value = 1.0;
  for (std::size_t k = 2; k <= order; ++k) value /= static_cast<double>(k);
  int terms = 1;
  coefficient[0] = value;
  for (double size = 1.0; terms < kMostTerms && size > 1e-18; ++terms) {
    const double divisor = static_cast<double>(static_cast<std::size_t>(terms) + order);
    coefficient[terms] = coefficient[terms - 1] / divisor;
    size *= largest / divisor;
  }
  double inverse_factorial[8] = {1.0};
  for (std::size_t k = 1; k < order; ++k) {
    inverse_factorial[k] = inverse_factorial[k - 1] / static_cast<double>(k);
  }
  const auto t = hn::Set(d, time);
  const Source poles(pole), states(state);
  const Target to(state);
  const std::size_t size = state.size();
  const double* gains = drive.data();
  const double* weight = weights.data();
  for (std::size_t i = 0; i < size; i += hn::Lanes(d)) {
    const ComplexVector mu = poles[i];
    const ComplexVector x = {hn::Mul(mu.re, t), hn::Mul(mu.im, t)};
    ComplexVector phi = {hn::Set(d, coefficient[terms - 1]), hn::Zero(d)};
    for (int p = terms - 1; p-- > 0;) {
      phi = Times(phi, x);
      phi.re = hn::Add(phi.re, hn::Set(d, coefficient[p]));
    }
    ComplexVector forced = {hn::Zero(d), hn::Zero(d)};
    for (std::size_t k = order; k-- > 0;) {  // phi is φ_{k+1} here
      const auto w = hn::Set(d, weight[k]);
      forced.re = hn::MulAdd(w, phi.re, forced.re);
      forced.im = hn::MulAdd(w, phi.im, forced.im);
      phi = Times(phi, x);
      phi.re = hn::Add(phi.re, hn::Set(d, inverse_factorial[k]));
    }
    const auto gain = hn::Load(d, gains + i);
    const ComplexVector free = Times(phi, states[i]);
    to.Set(i, {hn::MulAdd(gain, forced.re, free.re), hn::MulAdd(gain, forced.im, free.im)});
  }
}

void Polynomials(std::span<const Octet> table, const std::array<double, 4>& x,
                 std::array<Octet, 4>& out) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t k = 0; k < kVectorPadding; k += lanes) {
    Vector sum[4];
    for (std::size_t i = 0; i < 4; ++i) sum[i] = hn::Zero(d);
    for (std::size_t p = table.size(); p-- > 0;) {
      const auto coefficient = hn::LoadU(d, table[p].data() + k);
      for (std::size_t i = 0; i < 4; ++i) {
        sum[i] = hn::MulAdd(sum[i], hn::Set(d, x[i]), coefficient);
      }
    }
    for (std::size_t i = 0; i < 4; ++i) hn::StoreU(sum[i], d, out[i].data() + k);
  }
}

const ModalKernels* Table() {
  static constexpr ModalKernels kTable = {.advance = Advance,
                                          .advance_by = AdvanceBy,
                                          .real_products = RealProducts,
                                          .weighted_size = WeightedSize,
                                          .advance_driven = AdvanceDriven,
                                          .advance_driven_by = AdvanceDrivenFor,
                                          .polynomials = Polynomials};
  return &kTable;
}

}  // namespace modcal::event::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal::event {
HWY_EXPORT(Table);

const ModalKernels& modal_kernels() {
  static const ModalKernels& kernels = modal_kernels_of_allowed_set();
  return kernels;
}

const ModalKernels& modal_kernels_of_allowed_set() { return *HWY_DYNAMIC_DISPATCH(Table)(); }

}  // namespace modcal::event
#endif
