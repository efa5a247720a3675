// Constants of the shape of a force that were set by trial.
#pragma once

namespace modcal {

/// ln of the odds of a smooth force over pulses that are stated from which on the answer is
/// rejected.
/// Source: 18 blows of another program, without a stated window and in one of 0.2 s, have -446 to
/// -20; 65 saw-teeth and smooth forces 75 to 493, of which the band of pulses held 47 to 100 %.
/// Range tried: -20 to 70, by these.
/// Doubled: as it is.
/// Halved: as it is.
constexpr double kSmoothOdds = 10.0;

}  // namespace modcal
