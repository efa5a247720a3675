// Constants that were tuned, not derived. Twelve records of benchmarks/truth (T):
// libcalib/identifiability/tuning.hpp.
#pragma once

#include <cstddef>

namespace modcal {

/// Power over that of the noise read so far up to which a bin is clear of the response.
/// Source: the response there is 8e-4 of the signal or less.
/// Range tried: 0.7 to 2.8, on T.
/// Doubled: as it is.
/// Halved: f_n move by up to 1.0 sd, all as right.
constexpr double kClearNoise = 1.4;

/// Power over that of the noise up to which a bin is noise at most; it holds errors of the model,
/// too.
/// Source: lines begin to stand apart.
/// Range tried: 0.55 to 2.2, on T.
/// Doubled: eleven of twelve are refused: lines are taken for noise.
/// Halved: f_n move by up to 0.8 sd, all as right.
constexpr double kLineMargin = 1.1;

/// Bins from which noise is read at least.
/// Source: 200 powers tell it to 7 %.
/// Range tried: 100 to 400, on T.
/// Doubled: as it is.
/// Halved: as it is.
constexpr std::size_t kFewestNoiseBins = 200;

}  // namespace modcal
