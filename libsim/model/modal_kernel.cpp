#include "libsim/model/modal_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/model/modal_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/base/planar_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// ModalPole::denominator() of consecutive bins; on the frequency axis without the terms of σ.
template <bool kShifted>
HWY_INLINE ComplexVector Denominator(const ModalPole& pole, Vector omega, double sigma) {
  const Tag d;
  const double loss = 2.0 * pole.zeta * pole.omega;
  const auto center = hn::Set(d, pole.omega);
  const auto below = hn::Sub(center, omega), above = hn::Add(center, omega);
  if constexpr (kShifted) {
    return {hn::MulAdd(below, above, hn::Set(d, sigma * (sigma + loss))),
            hn::Mul(omega, hn::Set(d, loss + 2.0 * sigma))};
  } else {
    return {hn::Mul(below, above), hn::Mul(omega, hn::Set(d, loss))};
  }
}

HWY_INLINE void StorePart(Vector values, double* to, std::size_t count) {
  const Tag d;
  if (count == hn::Lanes(d)) {
    hn::StoreU(values, d, to);
    return;
  }
  HWY_ALIGN double part[kBinLanes];
  hn::Store(values, d, part);
  for (std::size_t j = 0; j < count; ++j) to[j] = part[j];
}

template <std::size_t kSums>
struct Totals {
  Vector real[kSums], imag[kSums];

  HWY_INLINE void Add(const double* const* numerators, std::size_t n,
                      const ComplexVector& denominator, Vector inverse) {
    const Tag d;
    const auto share = hn::Mul(denominator.re, inverse);
    const auto turned = hn::Mul(denominator.im, inverse);
    for (std::size_t r = 0; r < kSums; ++r) {
      const auto numerator = hn::Set(d, numerators[r][n]);
      real[r] = hn::MulAdd(numerator, share, real[r]);
      imag[r] = hn::NegMulAdd(numerator, turned, imag[r]);
    }
  }
};

// 1/x_0 … 1/x_3 by one division. |D|² lies within 1e-12 to 1e30 for frequencies in the range of
// numbers a structure can have, so that no product of four leaves the range of doubles.
template <bool kShifted, std::size_t kSums>
HWY_INLINE void AddFourTerms(const ModalPole* poles, const double* const* numerators, std::size_t n,
                             Vector omega, double sigma, Totals<kSums>& totals) {
  const Tag d;
  const ComplexVector d0 = Denominator<kShifted>(poles[n], omega, sigma);
  const ComplexVector d1 = Denominator<kShifted>(poles[n + 1], omega, sigma);
  const ComplexVector d2 = Denominator<kShifted>(poles[n + 2], omega, sigma);
  const ComplexVector d3 = Denominator<kShifted>(poles[n + 3], omega, sigma);
  const auto x0 = Power(d0), x1 = Power(d1);
  const auto x2 = Power(d2), x3 = Power(d3);
  const auto low = hn::Mul(x0, x1), high = hn::Mul(x2, x3);
  const auto inverse = hn::Div(hn::Set(d, 1.0), hn::Mul(low, high));
  const auto inverse_low = hn::Mul(inverse, high), inverse_high = hn::Mul(inverse, low);
  totals.Add(numerators, n, d0, hn::Mul(inverse_low, x1));
  totals.Add(numerators, n + 1, d1, hn::Mul(inverse_low, x0));
  totals.Add(numerators, n + 2, d2, hn::Mul(inverse_high, x3));
  totals.Add(numerators, n + 3, d3, hn::Mul(inverse_high, x2));
}

template <bool kShifted, std::size_t kSums>
void AddUp(std::span<const ModalPole> poles, const ModalSum* sums, const FrequencyGrid& grid,
           const BinRange& bins) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  // Kept where no store into the sums can be taken to change them.
  const double sigma = grid.sigma;
  const double* numerators[kSums];
  for (std::size_t r = 0; r < kSums; ++r) numerators[r] = sums[r].numerator;
  for (std::size_t i = 0; i < bins.size(); i += lanes) {
    const auto omega =
        hn::Mul(hn::Iota(d, static_cast<double>(bins.first + i)), hn::Set(d, grid.spacing));
    Totals<kSums> totals;
    for (std::size_t r = 0; r < kSums; ++r) totals.real[r] = totals.imag[r] = hn::Zero(d);
    std::size_t n = 0;
    for (; n + 4 <= poles.size(); n += 4) {
      AddFourTerms<kShifted>(poles.data(), numerators, n, omega, sigma, totals);
    }
    for (; n < poles.size(); ++n) {
      const ComplexVector denominator = Denominator<kShifted>(poles[n], omega, sigma);
      totals.Add(numerators, n, denominator, hn::Div(hn::Set(d, 1.0), Power(denominator)));
    }
    const std::size_t count = HWY_MIN(lanes, bins.size() - i);
    for (std::size_t r = 0; r < kSums; ++r) {
      StorePart(totals.real[r], sums[r].real + i, count);
      StorePart(totals.imag[r], sums[r].imag + i, count);
    }
  }
}

template <bool kShifted>
void AddUpAll(std::span<const ModalPole> poles, std::span<const ModalSum> sums,
              const FrequencyGrid& grid, const BinRange& bins) {
  std::size_t r = 0;
  for (; r + 3 <= sums.size(); r += 3) AddUp<kShifted, 3>(poles, &sums[r], grid, bins);
  if (sums.size() - r == 2) AddUp<kShifted, 2>(poles, &sums[r], grid, bins);
  if (sums.size() - r == 1) AddUp<kShifted, 1>(poles, &sums[r], grid, bins);
}

void AddUpModes(std::span<const ModalPole> poles, std::span<const ModalSum> sums,
                const FrequencyGrid& grid, const BinRange& bins) {
  (grid.sigma == 0.0 ? AddUpAll<false> : AddUpAll<true>)(poles, sums, grid, bins);
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(AddUpModes);

void add_up_modes(std::span<const ModalPole> poles, std::span<const ModalSum> sums,
                  const FrequencyGrid& grid, const BinRange& bins) {
  HWY_DYNAMIC_DISPATCH(AddUpModes)(poles, sums, grid, bins);
}
}  // namespace modcal
#endif
