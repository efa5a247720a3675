// The modes of a string above the highest stated one, as a few modes that answer alike in a band.
#pragma once

#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// The law that the modes above the highest stated one follow, and the band that is looked at.
struct HigherModeLaw {
  double fundamental = 0.0;    ///< f0 [Hz]
  double inharmonicity = 0.0;  ///< B [1]; taken for 0 where it is below
  std::size_t stated = 0;      ///< N, modes that are there already
  std::size_t apart = 0;       ///< modes N + 1 … `apart` − 1 stand for themselves
  double highest = 0.0;        ///< highest frequency of the band [Hz]
  /// The support feels T y_x − E I y_xxx instead of T y_x: g_rn times (1 + B n²).
  bool bending = false;
  /// Stated modes, the first, of which what they leave ringing is not smooth in the band.
  std::size_t ringing = std::numeric_limits<std::size_t>::max();

  /// Stated modes as in `basis`, for a band up to `highest` [Hz].
  static HigherModeLaw above(const ModalBasis& basis, double fundamental, double inharmonicity,
                             double highest, bool bending = false);
};

/// One of them: residue/(ω² + s²) joins the sum of odd or of even modes, R_1 = −(odd + even) F,
/// R_2 = (even − odd) F.
struct HigherMode {
  std::size_t number = 0;  ///< n, of a mode that stands for itself; 0: for many
  bool even = false;
  double omega = 0.0;       ///< [rad/s], in proportion to f0; by B as the law where number > 0
  double residue = 0.0;     ///< [1/s²]
  double by_contact = 0.0;  ///< ∂residue/∂x_c [1/(m s²)]
  double by_inharmonicity = 0.0;  ///< ∂residue/∂B [1/s²]
};

/// Σ_{n > N} a_n/(ω_n² + s²), a_n = T (nπ/L) sin(nπx_c/L)/m, of each parity for |s| up to the
/// band's end. The first modes stand for themselves. Of the others, with λ_n = 1/ω_n²,
///
///     Σ a_n λ_n/(1 + λ_n s²) = Σ a_n λ_n − s² Σ a_n λ_n²/(1 + λ_n s²):
///
/// the first sum in closed form (static response of the whole string less the modes before), the
/// second with 1/(1 + λs²) interpolated at Chebyshev's points of [0, λ_apart], which makes each
/// point a mode. Relative error below 1e-5 of the remainder; 200 modes apart take its place to
/// 1e-6 of |H| (a test). One mode far above the band is the constant.
std::vector<HigherMode> higher_modes(const HigherModeLaw& law, const ModalBasis& basis,
                                     double contact);

/// How many higher_modes() gives, whatever f0, B and x_c are: those that stand for themselves come
/// first.
std::size_t higher_mode_count(const HigherModeLaw& law);

}  // namespace modcal
