// What one mode adds to the columns of its frequency and damping: included once for each
// instruction set, hence the guard that toggles.
#if defined(MODCAL_MODE_TERMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef MODCAL_MODE_TERMS_INL
#undef MODCAL_MODE_TERMS_INL
#else
#define MODCAL_MODE_TERMS_INL
#endif

#include "libcalib/likelihood/kernels/mode_columns.hpp"
#include "libcalib/likelihood/kernels/planar_complex-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// What a mode adds to a column: force times `drive`, and z^−1 times `decay`.
struct Slopes {
  C drive, decay;
};
struct ModeTerms {
  C inverse;  // 1/D_n
  Slopes frequency, damping;
};
HWY_INLINE ModeTerms TermsOf(const LikelihoodMode& mode, std::size_t n, const ColumnTask& task,
                             const Bins& bins, C delay) {
  ModeTerms terms{InverseDenominator(mode, bins), {Zero(), Zero()}, {Zero(), Zero()}};
  const C drive = Scale(Mul(terms.inverse, terms.inverse), Real(-mode.residue));
  terms.damping.drive = Mul(drive, Scale(bins.s, Real(mode.two_zeta_omega)));
  terms.frequency.drive = AddScaled(terms.damping.drive, drive, Real(2.0 * mode.omega_squared));
  if (task.by_frequency.empty() || !mode.decays) return terms;
  // c U² E' + conj(c) U'² conj(E').
  const Decays decays = DecaysAt(mode.pole, delay);
  const C square = Mul(decays.u, decays.u);
  const C square_conj = Mul(decays.u_conj, decays.u_conj);
  const C frequency = Set(task.by_frequency[n]);
  const C damping = Set(task.by_damping[n]);
  terms.frequency.decay = AddConjMul(Mul(frequency, square), frequency, square_conj);
  terms.damping.decay = AddConjMul(Mul(damping, square), damping, square_conj);
  return terms;
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
