// A free decay at a lower rate, its poles unchanged.
#pragma once

#include <complex>

#include "libinverse/modes/decay_record.hpp"

namespace modcal {

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

/// Keeps 0 … highest [Hz] (to 1e-4 of the amplitude) and stops everything above half the new rate
/// by 80 dB (Kaiser, 1974); the new rate is the lowest whole fraction of the old one above
/// 2.6·highest. The record itself where that is the old rate. Throws InvalidInput for an invalid
/// record, a band above half its rate, a record shorter than twice the filter.
DecimatedDecay decimate(const DecayRecord& record, double highest);

}  // namespace modcal
