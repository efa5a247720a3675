// The stiff-string law through measured modal frequencies.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace modcal {

class ResultVisitor;

/// Outcome of a fit of f_n = n f₀ √(1 + B n²).
struct StiffStringFit {
  double fundamental = std::numeric_limits<double>::quiet_NaN();    ///< f₀ [Hz]
  double inharmonicity = std::numeric_limits<double>::quiet_NaN();  ///< B [1]; may come out < 0
  /// Standard deviations of f₀ and B from the scatter about the law; NaN with two modes.
  double fundamental_deviation = std::numeric_limits<double>::quiet_NaN();
  double inharmonicity_deviation = std::numeric_limits<double>::quiet_NaN();
  double rms_residual = std::numeric_limits<double>::quiet_NaN();  ///< weighted rms [Hz]
  std::size_t modes = 0;                                           ///< modes with weight > 0
  std::size_t iterations = 0;                                      ///< Gauss–Newton steps taken
  bool converged = false;

  /// f_n of the law [Hz], n ≥ 1.
  double frequency(std::size_t n) const;
  /// f₀ and B with their deviations.
  void visit(ResultVisitor& visitor) const;
};

/// B, 0 where no mode could tell it from zero: by 1e-12 mode 5000 moves by 1e-5, mode 50 by 1e-9.
double without_rounding(double inharmonicity);

/// B without_rounding() for a sentence; one within three standard
/// deviations of zero stands with its deviation.
std::string inharmonicity_text(double inharmonicity,
                               double deviation = std::numeric_limits<double>::quiet_NaN());

/// Minimum of Σ_n w_n (f_n − n f₀ √(1 + B n²))² (Debut, Delaune and Antunes, 2010, eq. 18, with the
/// ideal fundamental f₀), started from the linear fit of f_n²/n² = f₀² + f₀² B n² and refined by
/// Gauss–Newton. frequencies: f_1 … f_N [Hz]; weights: N numbers ≥ 0, 0 leaves a mode out (an
/// unexcited mode, say), empty: all 1. A frequency with weight 0 is not looked at.
/// Throws InvalidInput for fewer than two modes with weight, f_n ≤ 0, or frequencies so far from
/// any such law that f₀² or 1 + B N² would not be positive.
StiffStringFit fit_stiff_string(std::span<const double> frequencies,
                                std::span<const double> weights = {});

/// The frequencies with those of unexcited modes replaced by the law's (section 7.1 of the paper).
std::vector<double> fill_unexcited_modes(std::span<const double> frequencies,
                                         const std::vector<bool>& excited,
                                         const StiffStringFit& fit);

}  // namespace modcal
