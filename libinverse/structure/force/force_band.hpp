// What is not known of a force outside of the measured band.
#pragma once

#include <Eigen/Core>

#include "libinverse/structure/bin_evidence.hpp"

namespace modcal {

/// Sum over the bins outside of the band of a force of `power` in those of the band: below as at
/// its lower end, above as its upper octave goes on by a power of frequency, which does not rise.
double power_outside(const ContourSpectra& spectra, const std::vector<double>& power);

/// The same above the band of a force whose `power` (found, a bin) is that of few lines, as of one
/// that comes again and again: where it jumps, harmonic n has P_1/n², and those above the band's
/// top f_t have about Σ P_n (f_n/f_t)², of which 1 − f_t/f_Nyq lies below half the sample rate. 0:
/// there is one line alone, or more than few by (Σ w)²/Σ w² of w = P (f/f_t)² (participation
/// ratio) and kFewLines of the bins.
double power_of_lines_outside(const ContourSpectra& spectra, const std::vector<double>& power);

/// Power of the force in every bin, less what noise makes of it: below 0 at times.
std::vector<double> power_found(const BinEvidence& evidence);

/// How many times the density of a force's power in the lowest bins of its band, up to twice its
/// least frequency, is that in the next so wide octave: 1 of white noise, 4 and more of a force
/// whose mean or slow part stands below. NaN: a band too narrow to tell. first: of the band's bins.
double rise_towards_zero(const std::vector<double>& power, std::size_t first);

/// Σ f⁴ n/(Σ f²)²: 3 of a Gaussian force, the inverse of the share of time in which one of blows
/// acts.
double peakedness(const Eigen::Ref<const Eigen::VectorXd>& force);

/// ln of the odds that the force is a push that sets in or is let go and no blow: Σ ln p of what
/// the bins show of its power, exponential about A exp(−(ω/ω_c)^k)/|s|² and A exp(−(ω/ω_c)^k) and
/// the noise, with the A, ω_c and k of largest likelihood each (Itakura and Saito's divergence). Of
/// correlated bins one counts. NaN: a push would not be told, its own odds being less than
/// kPushOdds.
double log_odds_of_push(const BinEvidence& evidence, const ContourSpectra& spectra);

/// Variance of the samples of pulses whose spectrum above `high` [Hz] is supposed, not measured:
/// all of it may be otherwise, within half a period of `high` of where it stands: the largest of
/// its squared envelope there, by Hilbert's transform. high > 0.
Eigen::VectorXd variance_of_shape(const Eigen::VectorXd& force, double rate, double high);

/// Variance of the samples of pulses whose shape is not known. What stands outside of the band has
/// the mean power `outside` [N²], weighted by exp(−2σt), and stands where the upper half of the
/// band does.
Eigen::VectorXd variance_about(const Eigen::VectorXd& force, const ContourSpectra& spectra,
                               double outside);

/// (K − 1)/K Σ_k (f_k − mean)² of the forces without one of K sensors each, times the square by
/// which Student's t of so few is wider than the normal.
Eigen::VectorXd jackknife(const std::vector<Eigen::VectorXd>& forces);

}  // namespace modcal
