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

// Calls body(offset) at every vector of the bins; the tail goes through a call with `count` <
// lanes.
template <typename Body>
HWY_INLINE void ForVectors(std::size_t bins, Body body) {
  const std::size_t lanes = hn::Lanes(Tag());
  std::size_t i = 0;
  for (; i + lanes <= bins; i += lanes) body(i, lanes);
  if (i < bins) body(i, bins - i);
}

HWY_INLINE Vector LoadPart(const double* from, std::size_t count) {
  const Tag d;
  if (count == hn::Lanes(d)) return hn::LoadU(d, from);
  HWY_ALIGN double part[kBandLanes] = {};
  for (std::size_t j = 0; j < count; ++j) part[j] = from[j];
  return hn::Load(d, part);
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

// sums_r += a_r z for both ends.
HWY_INLINE void Accumulate(const TwoSidedTerm& term, const ComplexVector& z,
                           const TwoSidedSums& sums, std::size_t i, std::size_t count) {
  const Tag d;
  for (std::size_t r = 0; r < 2; ++r) {
    const auto a = hn::Set(d, term.residue[r]);
    StorePart(hn::MulAdd(a, z.real, LoadPart(sums.real[r] + i, count)), sums.real[r] + i, count);
    StorePart(hn::MulAdd(a, z.imag, LoadPart(sums.imag[r] + i, count)), sums.imag[r] + i, count);
  }
}

void AddUpTerms(std::span<const TwoSidedTerm> terms, double spacing, const TwoSidedSums& sums) {
  const Tag d;
  ForVectors(sums.bins, [&](std::size_t i, std::size_t count) HWY_ATTR {
    const auto omega = OmegaOf(sums.first_bin + i, spacing);
    ComplexVector left{hn::Zero(d), hn::Zero(d)};
    ComplexVector right = left;
    for (const TwoSidedTerm& term : terms) {
      const ComplexVector denominator = Denominator(term.omega, term.zeta, omega);
      const auto inverse = hn::Div(hn::Set(d, 1.0), SquaredMagnitude(denominator));
      const auto real = hn::Mul(denominator.real, inverse);
      const auto imag = hn::Mul(denominator.imag, inverse);
      left.real = hn::MulAdd(hn::Set(d, term.residue[0]), real, left.real);
      left.imag = hn::NegMulAdd(hn::Set(d, term.residue[0]), imag, left.imag);
      right.real = hn::MulAdd(hn::Set(d, term.residue[1]), real, right.real);
      right.imag = hn::NegMulAdd(hn::Set(d, term.residue[1]), imag, right.imag);
    }
    StorePart(left.real, sums.real[0] + i, count);
    StorePart(left.imag, sums.imag[0] + i, count);
    StorePart(right.real, sums.real[1] + i, count);
    StorePart(right.imag, sums.imag[1] + i, count);
  });
}

// 1/D_new − 1/D_old = (D_old − D_new)/(D_old D_new).
void MoveTerm(const TwoSidedTerm& from, double new_omega, double spacing,
              const TwoSidedSums& sums) {
  const Tag d;
  const double step = from.omega - new_omega;
  const auto real_step = hn::Set(d, step * (from.omega + new_omega));
  const auto imag_slope = hn::Set(d, 2.0 * from.zeta * step);
  ForVectors(sums.bins, [&](std::size_t i, std::size_t count) HWY_ATTR {
    const auto omega = OmegaOf(sums.first_bin + i, spacing);
    const ComplexVector old_d = Denominator(from.omega, from.zeta, omega);
    const ComplexVector new_d = Denominator(new_omega, from.zeta, omega);
    const ComplexVector product{
        hn::NegMulAdd(old_d.imag, new_d.imag, hn::Mul(old_d.real, new_d.real)),
        hn::MulAdd(old_d.real, new_d.imag, hn::Mul(old_d.imag, new_d.real))};
    const auto imag_step = hn::Mul(imag_slope, omega);
    const auto inverse = hn::Div(hn::Set(d, 1.0), SquaredMagnitude(product));
    const ComplexVector change{
        hn::Mul(hn::MulAdd(real_step, product.real, hn::Mul(imag_step, product.imag)), inverse),
        hn::Mul(hn::NegMulAdd(real_step, product.imag, hn::Mul(imag_step, product.real)), inverse)};
    Accumulate(from, change, sums, i, count);
  });
}

void LeaveOutTerm(const TwoSidedTerm& term, double spacing, const TwoSidedSums& sums,
                  const TwoSidedSums& rest) {
  const Tag d;
  const std::size_t shift = rest.first_bin - sums.first_bin;
  const std::size_t padded = (rest.bins + kBandLanes - 1) / kBandLanes * kBandLanes;
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t i = rest.bins; i < padded; ++i) rest.real[r][i] = rest.imag[r][i] = 0.0;
  }
  ForVectors(rest.bins, [&](std::size_t i, std::size_t count) HWY_ATTR {
    const ComplexVector denominator =
        Denominator(term.omega, term.zeta, OmegaOf(rest.first_bin + i, spacing));
    const auto inverse = hn::Div(hn::Set(d, 1.0), SquaredMagnitude(denominator));
    const auto real = hn::Mul(denominator.real, inverse);
    const auto imag = hn::Mul(denominator.imag, inverse);
    for (std::size_t r = 0; r < 2; ++r) {
      const auto a = hn::Set(d, term.residue[r]);
      const auto total_real = LoadPart(sums.real[r] + shift + i, count);
      const auto total_imag = LoadPart(sums.imag[r] + shift + i, count);
      StorePart(hn::NegMulAdd(a, real, total_real), rest.real[r] + i, count);
      StorePart(hn::MulAdd(a, imag, total_imag), rest.imag[r] + i, count);
    }
  });
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

// Both quotients |D|²/n_1 and |D|²/n_2 by one division: q = |D|²/(n_1 n_2), q n_2 and q n_1.
HWY_INLINE double IntegrateBoth(const CandidateBand& band, double candidate) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  auto sum = hn::Zero(d);
  for (std::size_t i = 0; i < band.rest.bins; i += lanes) {
    const ComplexVector denominator =
        Denominator(candidate, band.term.zeta, OmegaOf(band.rest.first_bin + i, band.spacing));
    const auto left = NumeratorPower(band, 0, i, denominator);
    const auto right = NumeratorPower(band, 1, i, denominator);
    const auto quotient = hn::Div(SquaredMagnitude(denominator), hn::Mul(left, right));
    sum = hn::MulAdd(hn::LoadU(d, band.magnitude[0] + i), hn::Sqrt(hn::Mul(quotient, right)), sum);
    sum = hn::MulAdd(hn::LoadU(d, band.magnitude[1] + i), hn::Sqrt(hn::Mul(quotient, left)), sum);
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

HWY_INLINE double IntegrateOne(const CandidateBand& band, std::size_t r, double candidate) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  auto sum = hn::Zero(d);
  for (std::size_t i = 0; i < band.rest.bins; i += lanes) {
    const ComplexVector denominator =
        Denominator(candidate, band.term.zeta, OmegaOf(band.rest.first_bin + i, band.spacing));
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
HWY_EXPORT(MoveTerm);
HWY_EXPORT(LeaveOutTerm);
HWY_EXPORT(IntegrateCandidates);

void add_up_terms(std::span<const TwoSidedTerm> terms, double spacing, const TwoSidedSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddUpTerms)(terms, spacing, sums);
}

void move_term(const TwoSidedTerm& from, double new_omega, double spacing,
               const TwoSidedSums& sums) {
  HWY_DYNAMIC_DISPATCH(MoveTerm)(from, new_omega, spacing, sums);
}

void leave_out_term(const TwoSidedTerm& term, double spacing, const TwoSidedSums& sums,
                    const TwoSidedSums& rest) {
  HWY_DYNAMIC_DISPATCH(LeaveOutTerm)(term, spacing, sums, rest);
}

void integrate_candidates(const CandidateBand& band, std::span<const double> candidates,
                          std::span<double> integrals) {
  HWY_DYNAMIC_DISPATCH(IntegrateCandidates)(band, candidates, integrals);
}
}  // namespace modcal
#endif
