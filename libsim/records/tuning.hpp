// Constants that were chosen, not derived. Records: strings of benchmarks/truth, 1 s at 51.2 kHz.
#pragma once

#include <cstddef>
#include <cstdint>

namespace modcal {

/// Share of the sampling rate below which a record's modes lie. The joint likelihood looks no
/// further: above it aliases of the force's jumps are no longer small, and the noise is read there.
/// Source: likelihood_band(), noise_deviation().
/// Range tried: 0.15 to 0.4 (30 to 90 modes stated).
/// Doubled: not possible, modes would lie above half the rate.
/// Halved: 30 modes of a violin D string in the place of 58, B known to 3.4e-8 in the place of
/// 9e-9.
constexpr double kModesBelow = 0.4;

/// Power about a mode over that of the noise from which on it stands out.
/// Source: noise alone has a mean of 1 with a standard deviation of 0.05 to 0.2 over f0 T bins.
/// Range tried: 1.25 to 3.
/// Doubled: of violin D, G and cello D strings at 1 % of noise 57, 68, 84 modes (58, 77, 84 as it
/// is, of 59, 77, 90 in the band), at 20 % 41, 35, 32 (57, 47, 53).
/// Halved: all that the band holds, as noise alone stands out.
constexpr double kStandsOut = 1.5;

/// Modes that are taken even where none stands out.
/// Source: fewer hardly tell f0, B and x_c apart; ten cost next to nothing.
/// Range tried: none; on no record of benchmarks/truth with up to 50 % of noise it decides.
/// Doubled: the same there.
/// Halved: the same there.
constexpr std::int64_t kFewestModes = 10;

/// Modes that are taken at most unasked: a fit of every frequency takes more than their square in
/// time, and those left out are held by the law's modes above.
/// Source: of a cello D string at 1 % of noise 90 modes took five times the time of 50.
/// Range tried: 30 to 90.
/// Doubled: a cello C string, with 128, takes minutes.
/// Halved: 30 modes of a violin D string in the place of 58, B known to 3.4e-8 in the place of
/// 9e-9.
constexpr std::int64_t kMostModes = 60;

/// How far a stated sample rate may be from that of the file, relative: a clock that was calibrated
/// against its nominal rate. Beyond, one of both is wrong.
/// Source: plain crystals are up to 1e-4 off, the least mistake of names is the 1e-3 of 44.1 for
/// 44.056 kHz.
/// Range tried: 2.5e-4 to 1e-3.
/// Doubled: 44.056 kHz stated for 44.1 is used with a warning.
/// Halved: bad records are refused as now.
constexpr double kCalibratedClock = 5e-4;

/// How far two rates in one file may be apart, relative, to be the same.
/// Source: six digits of a period hold 5e-6 of it.
/// Range tried: this.
/// Doubled: two clocks 2e-5 apart are one.
/// Halved: six digits of a period just hold it.
constexpr double kSameRate = 1e-5;

/// Whole numbers of hertz about the mean rate that are tried for one on whose grid all printed
/// instants lie. Source: 3352 columns of 3 to 1000 instants of 1 kHz to 1 MHz, printed to a quarter
/// of a step or better; 87 % have the nearest one, all have one. Without it the mean is taken.
/// Range tried: 1 to 800.
/// Doubled: 6 of them have the mean in the place of 20.
/// Halved: 58 have the mean.
constexpr int kMostRatesTried = 64;

/// By how much of a sample channels of one record may begin apart.
/// Source: instants since 1904 hold 5e-7 s, .03 samples at 51.2 kHz.
/// Range tried: this.
/// Doubled: turns a response by 18 degrees at half the rate.
/// Halved: such instants would be refused.
constexpr double kSameInstant = 0.05;

/// Instant of a first sample [s] beyond which it counts from the epoch of a calendar, not from the
/// beginning of the record.
/// Source: twelve days; seconds since 1970 or 1904 are above 10^9.
/// Range tried: this.
/// Doubled: the same for all dates since 1970.
/// Halved: the same.
constexpr double kLatestStart = 1e6;

/// Samples before a run of equal ones at the end in which a string that rings out is within the
/// last two steps of the resolution. Source: 43 decays of sines (65 to 659 Hz, 8 to 16 bits, 0.02
/// to 1 s), none of which is called cut, and 2000 sawtooths of 8 bits cut at random and filled with
/// 0 or the last value, which all are. Range tried: 64 to 1024. Doubled: as now. Halved: as now.
constexpr std::size_t kRingsOut = 256;

/// So many lines may lie below the first one of a response function: those are kept, as NaN, in
/// 16 bytes each.
/// Source: a zoom to .01 Hz at 10 kHz has 10^6.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kMostLinesBefore = 1e7;

/// Power a bin above a band's edge over that below it from which on the record is empty there.
/// Source: violin strings low-passed at 16 to 20 kHz to 2e-10 to 2e-9 have forces of up to 3000
/// times the true one at the record's ends; one of an elliptic filter with 6e-5 is right. Of 60
/// other records of 8 to 96 kHz, some of them resampled, none has an edge.
/// Range tried: 1e-5 and 1e-4, at which the elliptic one is refused.
/// Doubled: the same, as none of these lies between 2e-9 and 6e-5.
/// Halved: the same.
constexpr double kEmptyBand = 1e-5;

/// Samples of a record whose edge is looked for: 16 bins a band.
/// Source: the median of 16 powers scatters by a third.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kShortestBandRecord = 3200;

/// Share of the samples of one run of zeros from which on a channel rests there, and of its zeros
/// that such runs may lack where it is not clipped.
/// Source: a blow lasts a hundredth of its record; a signal that is cut at 0 comes back every
/// period. Range tried: this. Doubled: not tried. Halved: not tried.
constexpr double kRestAtZero = 0.1;

/// Equal samples in a row at an extreme value that are a clipped peak.
/// Source: two alike stand at the top of many a sine.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kShortestClip = 3;

/// Samples of a record below which noise is not read and no spike is looked for.
/// Source: not derived; its band has eleven bins.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kShortestNoiseRecord = 64;

/// Band, over half the sample rate, in which white noise is read.
/// Source: below, most records have signal; above, filters against aliasing have cut it.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kNoiseBandLow = 0.6;
constexpr double kNoiseBandHigh = 0.95;

/// Step of a time axis over the median one from which on there is a gap.
/// Source: half way to a missing sample.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kTimeGap = 1.5;

/// Deviation of instants from even steps [steps] that is worth a word, beyond what they are printed
/// to.
/// Source: not derived; it turns what is at half the rate by 2 degrees.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kTimeJitter = 0.01;

/// Resolution of printed instants [steps] beyond which they are coarse, and a missing sample cannot
/// be told.
/// Source: not derived.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kCoarseTime = 0.25;

}  // namespace modcal
