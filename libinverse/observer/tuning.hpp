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

/// Share of the record before steady motion, for the model error of the bands.
/// Source: that of observed_record.cpp.
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

}  // namespace modcal::observer
