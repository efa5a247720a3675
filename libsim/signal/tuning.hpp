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
/// Source: large grids keep within 0.4 % where nothing fails.
/// Range tried: 0.0025 to 0.01, in 214 decays of structures, 27 of them with hum.
/// Doubled: hum is seen in one record that has none, and a mode is lost with it.
/// Halved: hum is missed in one record.
constexpr double kMainsTolerance = 0.005;

/// Shift in time [sample periods] below which it is rounding of the given numbers.
/// Source: a delay as a user prints it times a rate.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kNegligibleShift = 1e-9;

}  // namespace modcal
