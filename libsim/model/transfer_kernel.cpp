#include "libsim/model/transfer_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/model/transfer_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// With s = σ + iω: denominator = (ω_n² + σ² − ω² + 2ζω_nσ) + i (2σω + 2ζω_nω).
void SumModalTerms(std::span<const ModalTerm> terms, double spacing, double sigma,
                   std::span<Complex> out) {
  const hn::ScalableTag<double> d;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN double tail[2 * hn::MaxLanes(hn::ScalableTag<double>())];
  for (std::size_t k = 0; k < out.size(); k += lanes) {
    const auto index = hn::Iota(d, static_cast<double>(k));
    const auto omega = hn::Mul(index, hn::Set(d, spacing));
    const auto s_squared = hn::NegMulAdd(omega, omega, hn::Set(d, sigma * sigma));
    const auto two_sigma_omega = hn::Mul(omega, hn::Set(d, 2.0 * sigma));
    auto sum_real = hn::Zero(d);
    auto sum_imag = hn::Zero(d);
    for (const ModalTerm& term : terms) {
      const auto real =
          hn::Add(s_squared, hn::Set(d, term.omega_squared + term.two_zeta_omega * sigma));
      const auto imag = hn::MulAdd(omega, hn::Set(d, term.two_zeta_omega), two_sigma_omega);
      const auto norm = hn::MulAdd(real, real, hn::Mul(imag, imag));
      const auto scale = hn::Div(hn::Set(d, term.residue), norm);
      sum_real = hn::MulAdd(scale, real, sum_real);
      sum_imag = hn::NegMulAdd(scale, imag, sum_imag);
    }
    double* target = reinterpret_cast<double*>(out.data() + k);
    if (k + lanes <= out.size()) {
      hn::StoreInterleaved2(sum_real, sum_imag, d, target);
    } else {
      hn::StoreInterleaved2(sum_real, sum_imag, d, tail);
      for (std::size_t j = 0; j < 2 * (out.size() - k); ++j) target[j] = tail[j];
    }
  }
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {
HWY_EXPORT(SumModalTerms);

void sum_modal_terms(std::span<const ModalTerm> terms, double spacing, double sigma,
                     std::span<Complex> out) {
  HWY_DYNAMIC_DISPATCH(SumModalTerms)(terms, spacing, sigma, out);
}
}  // namespace modcal
#endif
