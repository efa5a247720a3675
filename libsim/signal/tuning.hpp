// Constants that were tuned, not derived. Records: bowed violin D and G strings of
// benchmarks/truth, 1 s, 1 % of noise, hum of 50 Hz and its harmonics, amplitudes 1/h of that
// stated.
#pragma once

namespace modcal {

/// Power of a line of the mains over the median of the bins about it. A false alarm takes a few
/// bins and doubles the time of a fit; it biases nothing.
/// Source: without hum 9 is the most of first and second lines, 36 of others; of 0.1 % of hum,
/// which does no harm yet, the first line has 71 to 93, of 1 % 8700 and more.
/// Range tried: 15 to 60.
/// Doubled: every hum is found as now.
/// Halved: every hum is found as now, and lines beside it that are none help to place it.
constexpr double kLineRatio = 30.0;

/// How far the mains may be from 50 and 60 Hz, over these.
/// Source: large grids keep within 0.4 % where nothing fails, clocks of recorders within 1e-4.
/// Range tried: 0.005 to 0.02, in plucks of structures with modes that hardly decay near 60 Hz.
/// Doubled: more of those modes are taken for hum.
/// Halved: hum of 50.2 Hz is no longer found.
constexpr double kMainsTolerance = 0.005;

}  // namespace modcal
