// Constants that were tuned, not derived.
#pragma once

#include <cstddef>

namespace modcal::observer {

/// By how much the mean square error of the observer is taken larger than its difference to the
/// joint estimate tells: both err with the same noise, which that difference lacks.
/// Source: records of benchmarks/truth, violin D, exponential friction, 1 and 5 % of noise.
/// Range tried: 0.7 to 2.8.
/// Doubled: the 95 % band of the model-based force holds 98 % in the place of 94 to 95 %; the error
/// of both together at 5 % of noise is 0.049 in the place of 0.051 (joint 0.050).
/// Halved: 91 to 92 %, and 0.057.
constexpr double kSharedNoise = 1.4;

/// End of the lowest band in which the two are held against each other [Hz].
/// Source: records of benchmarks/truth, violin D, exponential friction, 1 and 5 % of noise.
/// Range tried: 20 to 80.
/// Doubled: error and bands as now.
/// Halved: error and bands as now.
constexpr double kLowestBand = 40.0;

/// Fewest bins of a band.
/// Source: records of benchmarks/truth, violin D, exponential friction, 1 and 5 % of noise.
/// Range tried: 32 to 64.
/// Doubled: error and bands as now.
/// Halved: not tried.
constexpr double kFewestBins = 32.0;

/// Share of the observer in the combined force from which on it is followed though no law explains
/// the record, and above the band that the joint estimate knows.
/// Source: records of benchmarks/truth, violin D, exponential friction, 1 and 5 % of noise.
/// Range tried: 0.25 to 1.
/// Doubled: the joint estimate wherever no law explains the record.
/// Halved: at 5 % of noise, share 0.31, 0.051 in the place of the joint estimate's 0.050.
constexpr double kTrustedShare = 0.5;

/// The same where a law explains the record.
/// Source: records of benchmarks/truth, violin D, exponential friction, 1 and 5 % of noise.
/// Range tried: 0.05 to 0.2.
/// Doubled: decides no record tried.
/// Halved: decides no record tried.
constexpr double kToldShare = 0.1;

/// Share of the record before steady motion, for the most frequent values and for the model error
/// of the bands.
/// Source: not derived.
/// Range tried: none.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kBeforeSteady = 0.3;

/// A contact whose resonance on the effective mass is so many times above the highest mode is
/// rigid. Source: records of benchmarks/truth, whose contacts are fitted with 6e4 to 2.5e5 N/m.
/// Range tried: 5 to 20.
/// Doubled: decides no record tried.
/// Halved: decides no record tried.
constexpr double kRigid = 10.0;

/// Most power of a force next to half the sample rate over that of lower frequencies (ringing()).
/// Source: records of benchmarks/truth: 0.5 (exponential) and 1.1 (thermal friction).
/// Range tried: 2.5 to 10.
/// Doubled: decides no record tried.
/// Halved: decides no record tried.
constexpr double kMostRinging = 5.0;

/// Slip over the largest one of the record below which the contact sticks, and fewest samples of a
/// cell, for the points of the friction curve.
/// Source: not derived; the curve is drawn, and no estimate rests on it.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kLeastSlipShare = 0.02;
constexpr std::size_t kLeastCellSamples = 5;

/// Standard deviations from which two laws count as told apart.
/// Source: by chance one record in 370.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kToldApart = 3.0;

/// Draws of further noise by which the deviation of the motion is told.
/// Source: it is known to 1/√32 so.
/// Range tried: this.
/// Doubled: to 1/√64, at twice the time of the runs.
/// Halved: to 1/√16.
constexpr std::size_t kNoiseDraws = 16;

/// By how much the deviations under the sensors' noise alone are taken larger, as fitted parameters
/// are off, too. The formal covariance of the fit is far too small: its innovations answer
/// chaotically.
/// Source: without it the 95 % bands of records of 0.2 and 1 s at 2 and 5 % of noise hold the truth
/// 83 to 88 % of the time.
/// Range tried: 1 and this.
/// Doubled: not tried.
/// Halved: not tried; below 1 no deviation is widened.
constexpr double kParameterShare = 1.4;

/// Noise over signal below which a narrower gain pays.
/// Source: not derived.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kQuietNoise = 0.015;

/// Cells between the 0.2 and 99.8 % quantiles of which the fullest is the most frequent value.
/// Source: not derived; a cell is half a per cent of the range.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kHistogramCells = 200;

/// Share of a reaction's deviation that the prior of its offset grants the ripple of a finite
/// number of modes ahead of the first wave: less than a string of few modes asks for
/// (silent_ripple()).
/// Source: the observer knows the ripple, and a tight prior keeps friction forces and offsets from
/// shifting together.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kRippleShare = 0.003;

/// Share of a reaction's standard deviation below which its noise is not taken.
/// Source: below, the observer's gain would hold its own discretization for truth.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kNoiseFloor = 0.01;

/// Samples of one block, over which a gain is kept.
/// Source: not derived; 5 ms at 51.2 kHz, a period of a violin's G string.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kGainBlock = 256;

/// Innovation in standard deviations beyond which Huber's ρ is linear.
/// Source: of noise alone one in 370 is beyond.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kHuberCorner = 3.0;

/// Doublings by which a steady covariance is found, at most.
/// Source: not derived; an end, 2^40 samples are eight months at 51.2 kHz.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kMostDoublings = 40;

}  // namespace modcal::observer
