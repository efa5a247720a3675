// Constants that were tuned, not derived. Records: bowed violin D and G strings of
// benchmarks/truth, 1 s, 1 % of noise, hum of 50 Hz and its harmonics, amplitudes 1/h of that
// stated; f0 of the start 2 % low, right and 2 % high.
#pragma once

#include <cstddef>

namespace modcal {

/// How far from a mode of the start a line must lie, of the mode's frequency.
/// Source: the start may be off by 2 %, and the string plays a little flat.
/// Range tried: 0.02 to 0.08.
/// Doubled: every hum is found as now, by its first line.
/// Halved: the second partial of the G string is taken for a line of 400 Hz (ratio 43).
constexpr double kNearMode = 0.04;

/// What an end state costs that has the energy of the record (EndState).
/// Source: as large as that it is expected. A record each of the six strings of benchmarks/truth,
/// 0.1 to 5 % of noise: 300 evaluations in all. More costs likelihood (100: 40 of 9500, and tests
/// of 0.1 s see modes above that are not there at 3). Less leaves amplitudes to what noise says,
/// and a search takes more steps (0.1: 362 evaluations).
/// Range tried: 0.1 to 100.
/// Doubled: χ² as now to 6e-5, 296 evaluations.
/// Halved: χ² as now to 1e-4, 311 evaluations.
constexpr double kEndStateRidge = 1.0;

/// The same of a plain transient, of what a decay costs: it may be as large as it likes, and this
/// decides only where columns depend on each other.
/// Source: those records. Nothing depends on it.
/// Range tried: 3e-5 to 1.
/// Doubled: evaluations and χ² as now.
/// Halved: the same.
constexpr double kPlainShare = 1e-3;

// Twelve records of benchmarks/truth (T): libcalib/identifiability/tuning.hpp.

/// Bins either side over which the power of the force is a mean: in a line, and between lines.
/// Source: not derived; T, on which either changes little.
/// Range tried: 1 to 4, 30 to 120, on T.
/// Doubled: f_n move by up to 0.16 and 0.09 sd.
/// Halved: by up to 0.43 and 0.20 sd.
constexpr std::size_t kLineBins = 2;
constexpr std::size_t kFloorBins = 60;

/// Excess of five bins over noise that proves a line.
/// Source: noise has it once in 60 000.
/// Range tried: 7.5 to 30, on T.
/// Doubled: f_n move by up to 0.10 sd.
/// Halved: by up to 0.19 sd.
constexpr double kExcessProof = 15.0;

/// Bins either side over which the share of the noise in a bin is a mean.
/// Source: seven bins of two draws scatter by a quarter.
/// Range tried: 1 to 6, on T.
/// Doubled: f_n move by up to 0.20 sd.
/// Halved: by up to 0.09 sd.
constexpr std::size_t kNoiseBins = 3;

/// Share of the prior that is left of the information in any direction at least. The information
/// itself is positive: what is left is no less than the prior, save for the scatter of what noise
/// adds. A direction with less of it would be said to be worse known than before the record.
/// Source: a tenth is beyond that scatter.
/// Range tried: 0.05 to 0.2, on T.
/// Doubled: as it is.
/// Halved: as it is.
constexpr double kPriorShare = 0.1;

/// Draws of noise in the place of the record, by whose mean the information that noise alone feigns
/// is told (noise_information()).
/// Source: not derived; each costs an evaluation of the whole record.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kNoiseRepeats = 3;

/// The same for the weights of the bins: a mean over many bins needs fewer.
/// Source: not derived; each costs an evaluation of the whole record.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kWeightRepeats = 2;

/// Chunks of blocks that an evaluation is parted in, and blocks of a record below which it is one
/// chunk. Their number depends on the record alone, so that the bits do not depend on the threads.
/// Source: up to eight threads find work; below sixteen blocks threads cost more than they save.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kEvaluationChunks = 8;
constexpr std::size_t kSmallRecordBlocks = 16;

/// Most rows of the information that are found by themselves: beyond, all columns cost no more.
/// Source: skipping_benchmark (benchmarks/measured/studies.md): 1 to 6 rows take 1.6, 2.2, 2.8,
/// 3.3, 3.9 and 4.5 ms, all 52 rows 6.0 ms.
/// Range tried: 1 to 6.
/// Doubled: not possible, the kernels hold 8 columns.
/// Halved: not tried.
constexpr std::size_t kMostRows = 6;

/// What is added to the scaled normal matrix of the amplitudes of a pluck, of its unit diagonal:
/// modes that are alike leave it singular.
/// Source: not derived; far above a double's rounding.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kPluckRidge = 1e-9;

/// Bins to either side of a mode from which the power of a pluck about it is read.
/// Source: as many as kNeighborHalfBand.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kPluckHalfBand = 128;

}  // namespace modcal
