// Levels of a recorded channel: what inspection reports about its samples.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace modcal {

/// Runs of kShortestRun or more equal samples at the largest or the smallest value.
struct Clipping {
  std::size_t runs = 0;
  std::size_t samples = 0;  ///< samples in these runs
  std::size_t first = 0;    ///< index of the first of them
  double lowest = 0.0;
  double highest = 0.0;

  static constexpr std::size_t kShortestRun = 3;
};

/// A constant signal is not clipped, it is constant: no runs. Samples that are NaN end a run.
Clipping find_clipping(std::span<const double> samples);
/// "12 samples in 4 runs at …"
std::string text(const Clipping& clipping);

/// Moments over the finite samples, in the unit of the samples; NaN where there are none.
struct Levels {
  double mean;
  double std;
  double rms;
  double peak;  ///< largest magnitude
  double lowest;
  double highest;
  std::size_t not_finite;
  std::size_t first_not_finite;
};
Levels measure_levels(std::span<const double> samples);

/// Rms value of additive noise under the assumption that it is white and that at least half of the
/// bins of the band 0.6 … 0.95 of the Nyquist frequency hold noise only: the median over the band
/// of the Hann-windowed periodogram |X_k|² / Σw², divided by ln 2 (the median of an
/// exponential distribution over its mean), is the noise variance. The median keeps single lines of
/// the signal out. NaN for fewer than kShortestNoiseRecord samples or where one is not finite.
double white_noise_rms(std::span<const double> samples);
inline constexpr std::size_t kShortestNoiseRecord = 64;
inline constexpr double kNoiseBandLow = 0.6;
inline constexpr double kNoiseBandHigh = 0.95;

}  // namespace modcal
