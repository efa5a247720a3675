#include "libcalib/objectives/spectral_peak_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libcalib/objectives/spectral_peak_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, kBandLanes>;
using Vector = hn::Vec<Tag>;

struct ComplexVector {
  Vector real;
  Vector imag;
};

HWY_INLINE Vector SquaredMagnitude(const ComplexVector& z) {
  return hn::MulAdd(z.real, z.real, hn::Mul(z.imag, z.imag));
}

HWY_INLINE Vector OmegaOf(std::size_t bin, double spacing) {
  const Tag d;
  return hn::Mul(hn::Iota(d, static_cast<double>(bin)), hn::Set(d, spacing));
}

// ω_n² − ω² as a product: nothing cancels at the resonance but ω_n − ω itself.
HWY_INLINE ComplexVector Denominator(double omega_n, double zeta, Vector omega) {
  const Tag d;
  const auto pole = hn::Set(d, omega_n);
  return {hn::Mul(hn::Sub(pole, omega), hn::Add(pole, omega)),
          hn::Mul(omega, hn::Set(d, 2.0 * zeta * omega_n))};
}

HWY_INLINE void StorePart(Vector values, double* to, std::size_t count) {
  const Tag d;
  if (count == hn::Lanes(d)) {
    hn::StoreU(values, d, to);
    return;
  }
  HWY_ALIGN double part[kBandLanes];
  hn::Store(values, d, part);
  for (std::size_t j = 0; j < count; ++j) to[j] = part[j];
}

/// Sums of a vector of bins at both ends.
struct SumPair {
  ComplexVector left, right;
};

HWY_INLINE void AddTerm(const TwoSidedTerm& term, const ComplexVector& denominator, Vector inverse,
                        SumPair& sums) {
  const Tag d;
  const auto real = hn::Mul(denominator.real, inverse);
  const auto imag = hn::Mul(denominator.imag, inverse);
  const auto left = hn::Set(d, term.residue[0]);
  const auto right = hn::Set(d, term.residue[1]);
  sums.left.real = hn::MulAdd(left, real, sums.left.real);
  sums.left.imag = hn::NegMulAdd(left, imag, sums.left.imag);
  sums.right.real = hn::MulAdd(right, real, sums.right.real);
  sums.right.imag = hn::NegMulAdd(right, imag, sums.right.imag);
}

// 1/x_0 … 1/x_3 by one division. |D|² lies within 1e-12 to 1e30 for frequencies in the range of
// numbers a string can have, so that no product of four leaves the range of doubles.
HWY_INLINE void AddFourTerms(const TwoSidedTerm* terms, Vector omega, SumPair& sums) {
  const Tag d;
  const ComplexVector d0 = Denominator(terms[0].omega, terms[0].zeta, omega);
  const ComplexVector d1 = Denominator(terms[1].omega, terms[1].zeta, omega);
  const ComplexVector d2 = Denominator(terms[2].omega, terms[2].zeta, omega);
  const ComplexVector d3 = Denominator(terms[3].omega, terms[3].zeta, omega);
  const auto x0 = SquaredMagnitude(d0), x1 = SquaredMagnitude(d1);
  const auto x2 = SquaredMagnitude(d2), x3 = SquaredMagnitude(d3);
  const auto low = hn::Mul(x0, x1), high = hn::Mul(x2, x3);
  const auto inverse = hn::Div(hn::Set(d, 1.0), hn::Mul(low, high));
  const auto inverse_low = hn::Mul(inverse, high), inverse_high = hn::Mul(inverse, low);
  AddTerm(terms[0], d0, hn::Mul(inverse_low, x1), sums);
  AddTerm(terms[1], d1, hn::Mul(inverse_low, x0), sums);
  AddTerm(terms[2], d2, hn::Mul(inverse_high, x3), sums);
  AddTerm(terms[3], d3, hn::Mul(inverse_high, x2), sums);
}

void AddUpTerms(std::span<const TwoSidedTerm> terms, double spacing, const TwoSidedSums& sums) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < sums.bins; i += lanes) {
    const auto omega = OmegaOf(sums.first_bin + i, spacing);
    const auto zero = hn::Zero(d);
    SumPair total{{zero, zero}, {zero, zero}};
    std::size_t n = 0;
    for (; n + 4 <= terms.size(); n += 4) AddFourTerms(&terms[n], omega, total);
    for (; n < terms.size(); ++n) {
      const ComplexVector denominator = Denominator(terms[n].omega, terms[n].zeta, omega);
      const auto inverse = hn::Div(hn::Set(d, 1.0), SquaredMagnitude(denominator));
      AddTerm(terms[n], denominator, inverse, total);
    }
    const std::size_t count = HWY_MIN(lanes, sums.bins - i);
    StorePart(total.left.real, sums.real[0] + i, count);
    StorePart(total.left.imag, sums.imag[0] + i, count);
    StorePart(total.right.real, sums.real[1] + i, count);
    StorePart(total.right.imag, sums.imag[1] + i, count);
  }
}

// |rest_r D + a_r|².
HWY_INLINE Vector NumeratorPower(const CandidateBand& band, std::size_t r, std::size_t i,
                                 const ComplexVector& denominator) {
  const Tag d;
  const auto real = hn::LoadU(d, band.rest.real[r] + i);
  const auto imag = hn::LoadU(d, band.rest.imag[r] + i);
  const ComplexVector sum{
      hn::MulAdd(real, denominator.real,
                 hn::NegMulAdd(imag, denominator.imag, hn::Set(d, band.term.residue[r]))),
      hn::MulAdd(real, denominator.imag, hn::Mul(imag, denominator.real))};
  return SquaredMagnitude(sum);
}

// 1/√x for normal x > 0 within 1e-4.
HWY_INLINE Vector RoughInverseRoot(Vector x) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return Vector{_mm512_rsqrt14_pd(x.raw)};
#else
  // Half the exponent by an integer shift, within 3.5 %, then a cubic step.
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const auto bits = hn::ShiftRight<1>(hn::BitCast(du, x));
  const auto y = hn::BitCast(d, hn::Sub(hn::Set(du, 0x5FE6EB50C7B537A9ull), bits));
  const auto r = hn::Mul(x, hn::Mul(y, y));
  const auto cubic = hn::MulAdd(r, hn::Set(d, 0.375), hn::Set(d, -1.25));
  return hn::Mul(y, hn::MulAdd(r, cubic, hn::Set(d, 1.875)));
#endif
}

// Two steps of Newton's: 1e-4 becomes 1.5e-8 and then less than rounding.
HWY_INLINE Vector InverseRoot(Vector x) {
  const Tag d;
  const auto half = hn::Mul(x, hn::Set(d, 0.5));
  auto y = RoughInverseRoot(x);
  y = hn::Mul(y, hn::NegMulAdd(hn::Mul(half, y), y, hn::Set(d, 1.5)));
  return hn::Mul(y, hn::NegMulAdd(hn::Mul(half, y), y, hn::Set(d, 1.5)));
}

// |D|/√n_1 by multiplications, as |D|²/√(|D|² n_1), |D|/√n_2 by the hardware's division and root:
// the two run side by side and take about the same time.
HWY_INLINE double IntegrateBoth(const CandidateBand& band, double candidate) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  auto sum = hn::Zero(d);
  for (std::size_t i = 0; i < band.rest.bins; i += lanes) {
    const ComplexVector denominator =
        Denominator(candidate, band.term.zeta, hn::LoadU(d, band.omega + i));
    const auto left = NumeratorPower(band, 0, i, denominator);
    const auto right = NumeratorPower(band, 1, i, denominator);
    const auto power = SquaredMagnitude(denominator);
    const auto left_root = hn::Mul(power, InverseRoot(hn::Mul(power, left)));
    sum = hn::MulAdd(hn::LoadU(d, band.magnitude[0] + i), left_root, sum);
    const auto right_root = hn::Sqrt(hn::Div(power, right));
    sum = hn::MulAdd(hn::LoadU(d, band.magnitude[1] + i), right_root, sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

HWY_INLINE double IntegrateOne(const CandidateBand& band, std::size_t r, double candidate) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  auto sum = hn::Zero(d);
  for (std::size_t i = 0; i < band.rest.bins; i += lanes) {
    const ComplexVector denominator =
        Denominator(candidate, band.term.zeta, hn::LoadU(d, band.omega + i));
    const auto quotient =
        hn::Div(SquaredMagnitude(denominator), NumeratorPower(band, r, i, denominator));
    sum = hn::MulAdd(hn::LoadU(d, band.magnitude[r] + i), hn::Sqrt(quotient), sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

void IntegrateCandidates(const CandidateBand& band, std::span<const double> candidates,
                         std::span<double> integrals) {
  const bool both = band.magnitude[0] != nullptr && band.magnitude[1] != nullptr;
  const std::size_t only = band.magnitude[0] != nullptr ? 0 : 1;
  for (std::size_t j = 0; j < candidates.size(); ++j) {
    integrals[j] =
        both ? IntegrateBoth(band, candidates[j]) : IntegrateOne(band, only, candidates[j]);
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(AddUpTerms);
HWY_EXPORT(IntegrateCandidates);

void add_up_terms(std::span<const TwoSidedTerm> terms, double spacing, const TwoSidedSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddUpTerms)(terms, spacing, sums);
}

void integrate_candidates(const CandidateBand& band, std::span<const double> candidates,
                          std::span<double> integrals) {
  HWY_DYNAMIC_DISPATCH(IntegrateCandidates)(band, candidates, integrals);
}
}  // namespace modcal
#endif
