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

}  // namespace modcal
