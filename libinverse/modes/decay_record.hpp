// A free decay and what is found in it.
#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

namespace modcal {

/// Simultaneous samples of a structure that is left to itself, y_c(t_m), t_m = m/f_s.
struct DecayRecord {
  double sample_rate = 0.0;                   ///< f_s [Hz]
  std::vector<std::vector<double>> channels;  ///< of one length, in any units
  /// rounding_level() of each channel; empty: 1.
  std::vector<double> rounding = {};

  std::size_t samples() const { return channels.empty() ? 0 : channels.front().size(); }
  /// Throws InvalidInput for no channel, lengths that differ, a sample that is not finite, a rate
  /// that is not positive.
  void require_valid() const;
};

/// Variance at a mode's frequency of what has been rounded off samples that are multiples of a step
/// q, over that of white noise of its power: 1 + kRoundingExcess exp(−2π²σ²/q²), where noise of rms
/// √(σ² + q²/12) was read. What the noise does not cover follows the signal (Widrow and Kollár,
/// 2008: the exponential is the characteristic function of the noise at 1/q). step: 0 for none.
double rounding_level(double noise_rms, double step);

/// Pole λ = −ζω + iω√(1 − ζ²) of a free decay.
struct DecayPole {
  double frequency = std::numeric_limits<double>::quiet_NaN();      ///< ω/2π, undamped [Hz]
  double damping_ratio = std::numeric_limits<double>::quiet_NaN();  ///< ζ [1]; < 0: it grows

  static DecayPole of_exponent(std::complex<double> exponent);
  std::complex<double> exponent() const;  ///< λ [1/s]
};

/// A mode of a free decay, y_c(t) = Re(A_c exp(λt)).
struct DecayMode {
  DecayPole pole;
  DecayPole deviation;  ///< standard deviations of f and ζ; NaN where they are not known
  std::vector<std::complex<double>> amplitude;  ///< A_c at the first sample, per channel
  /// How much χ², the noise that of the band, rises without it, the poles of the others as they
  /// are; NaN where its columns cannot be told apart.
  double evidence = std::numeric_limits<double>::quiet_NaN();
  /// How much χ² would fall if its amplitude in every channel were a polynomial of second degree in
  /// time: what two poles behind one leave, and a frequency that changes.
  double departure = std::numeric_limits<double>::quiet_NaN();

  double power() const;  ///< Σ_c |A_c|²
};

/// The decay through a low-pass filter, every stride-th sample kept. Only outputs for which all
/// inputs are there are taken: a sum of damped exponentials stays one exactly, its poles unchanged
/// and its amplitudes times gain().
struct DecimatedDecay {
  DecayRecord record;
  std::size_t stride = 1;
  std::vector<double> taps;  ///< Σ h_j = 1
  double original_rate = 0.0;

  /// Σ_j h_j exp(λ j/f_s): amplitude after over amplitude before.
  std::complex<double> gain(std::complex<double> exponent) const;
  /// Variance of white noise of the same density within the band, over the variance of the noise in
  /// the record: the filter has taken the noise above the band away.
  double in_band_variance() const;
};

/// How a record is decimated, from its sizes alone.
struct Decimation {
  std::size_t stride = 1;
  std::vector<double> taps;
  std::size_t kept = 0;  ///< samples
  double rate = 0.0;     ///< of them [Hz]
};
/// Throws InvalidInput where decimate() does for a record of these sizes.
Decimation decimation_of(std::size_t samples, double sample_rate, double highest);

/// Keeps 0 … highest [Hz] (to 1e-4 of the amplitude) and stops everything above half the new rate
/// by 80 dB (Kaiser, 1974); the new rate is the lowest whole fraction of the old one above
/// 2.6·highest. The record itself where that is the old rate. Throws InvalidInput for an invalid
/// record, a band above half its rate, a record shorter than twice the filter.
DecimatedDecay decimate(const DecayRecord& record, double highest);

}  // namespace modcal
