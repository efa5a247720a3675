// Levels of a recorded channel: what inspection reports about its samples.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace modcal {

/// Runs of kShortestClip or more equal samples at the largest or the smallest value, where more
/// stand there than where a signal of few steps turns. Rest at 0 is none, where a run of it is a
/// tenth of the samples or more.
struct Clipping {
  std::size_t runs = 0;
  std::size_t samples = 0;  ///< samples in these runs
  std::size_t first = 0;    ///< index of the first of them
  double lowest = 0.0;
  double highest = 0.0;
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

// Equal samples that follow one another.

struct Run {
  std::size_t first = 0, count = 0;
  std::size_t end() const { return first + count; }
};

/// Calls visit(Run) for every run of samples, those of one sample too, in their order.
template <typename Visit>
void for_each_run(std::span<const double> samples, Visit visit) {
  for (std::size_t first = 0; first < samples.size();) {
    std::size_t end = first + 1;
    while (end < samples.size() && samples[end] == samples[first]) ++end;
    visit(Run{first, end - first});
    first = end;
  }
}

/// Smallest step between values that occur; infinite where all are equal.
double resolution_of(std::span<const double> samples);

// What the samples of one channel tell against it, whatever was recorded.

/// Samples that no sensor of a vibration has read.
struct SampleFault {
  std::size_t first = 0;  ///< index of the first of them
  std::string text;       ///< value, reason and remedy
};

/// The first that holds of finite samples:
/// - all are equal;
/// - the largest is so large or small that the sum of their squares leaves double precision;
/// - one stands farther beyond the range of all others than that range is wide (from 64 samples);
/// - they pile up at the largest or smallest value: runs of three or more there, and over twice
///   what the roundest top leaves between it and the next value. A sine, whose density is the
///   largest an extreme of a smooth signal has, leaves 1/(√2 − 1) times the samples of the next
///   value; noise and steeper tops leave fewer;
/// - within the signal a run of equal samples is so long that chance leaves one in 10⁹ records:
///   N rⁿ⁻¹ < 10⁻⁹ of n, where the share r of the other neighbors are equal. Where the signal
///   comes and goes by no more than two steps of its resolution it turns, and where it stays so for
///   as long before or behind it is silent;
/// - such a run ends the record, though the signal before is still more than two steps of the
///   resolution away: the channel was cut off.
/// A run of equal samples at the beginning is silence, too.
std::optional<SampleFault> find_fault(std::span<const double> samples);

/// The second of these alone.
std::optional<SampleFault> find_extreme_magnitude(std::span<const double> samples);

}  // namespace modcal
