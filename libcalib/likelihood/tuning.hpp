// Constants that were tuned, not derived. Records: bowed violin D and G strings of
// benchmarks/truth, 1 s, 1 % of noise, hum of 50 Hz and its harmonics, amplitudes 1/h of that
// stated; f0 of the start 2 % low, right and 2 % high.
#pragma once

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

}  // namespace modcal
