// Constants that were tuned, not derived. Twelve records of benchmarks/truth (T):
// libcalib/identifiability/tuning.hpp.
#pragma once

#include <cstddef>

namespace modcal {

/// Frequency over that of the highest mode from which a band holds noise alone. One that begins
/// below is read by its median.
/// Source: the response there is 8e-4 of the signal or less.
/// Range tried: 0.7 to 2.8, on T.
/// Doubled: as it is.
/// Halved: f_n move by up to 1.0 sd, all as right.
constexpr double kClearNoise = 1.4;

/// Frequency over that of the highest mode at which a band that is read by its median begins at
/// least.
/// Source: lines begin to stand apart; the band holds errors of the model, too.
/// Range tried: 0.55 to 2.2, on T.
/// Doubled: eleven of twelve are refused, as less than 200 bins are left up to 0.488 of the rate.
/// Halved: f_n move by up to 0.8 sd, all as right.
constexpr double kLineMargin = 1.1;

/// Bins from which noise is read at least.
/// Source: 200 powers tell it to 7 %.
/// Range tried: 100 to 400, on T.
/// Doubled: as it is.
/// Halved: as it is.
constexpr std::size_t kFewestNoiseBins = 200;

/// Standard deviation of a level that is read by the median of a band's bins over that of one read
/// by their mean.
/// Source: of independent bins 1/ln 2 = 1.44; under the window neighbors correlate, their powers
/// more than their places about the median.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kMedianOverMean = 1.28;

}  // namespace modcal
