// What several strikes say of a further one.
#pragma once

#include "libinverse/structure/strikes/pole_search.hpp"

namespace modcal {

/// How far one quantity of every mode is off in a further strike.
struct FurtherStrike {
  Eigen::VectorXd deviations;  ///< of the fit to all strikes against a further one, N
  Eigen::VectorXd scatters;    ///< of a strike about the mean of all, rms; N
};

/// values: S ≥ 2 strikes × N modes, ln f or ln ζ; told: N deviations of the fit to all strikes, by
/// what it leaves. What moves all modes alike, as warmth does, is the median of a strike's
/// departures; its variance has S − 1 degrees of freedom. The variance of what remains of a mode is
/// moderated by all modes' (Smyth, 2004, eqs. 8 and 12): s̃² = v (ν s₀² + (S−1) s²/v)/(ν + S − 1),
/// v = S told² + τ², so that a mode that moves more than others keeps its own. τ², common to all
/// modes, makes the median of s²/v that of χ²/(S−1). Each deviation is √(1 + 1/S) of both, wider by
/// Student's t over the normal distribution's, and what the fit to all is off the strikes' mean:
/// strikes whose frequencies differ make one common resonance that is wider than each.
/// common: of that fit, N. Throws InvalidInput for one strike or other sizes.
FurtherStrike further_strike(const Eigen::MatrixXd& values, const Eigen::VectorXd& told,
                             const Eigen::VectorXd& common);

/// Poles fitted to each strike alone, from those of all on.
std::vector<std::vector<ModalPole>> poles_of_each(const std::vector<SearchedStrike>& strikes,
                                                  const std::vector<SensorKind>& kinds,
                                                  const std::vector<ModalPole>& all);

/// The same of the logarithm of `quantity`, by the poles of each strike and of all; told: the
/// deviations of the latter.
FurtherStrike further_strike(const std::vector<std::vector<ModalPole>>& each,
                             const std::vector<ModalPole>& all, double ModalPole::*quantity,
                             const std::vector<double>& told);

}  // namespace modcal
