// Constants that were chosen, not derived.
#pragma once

namespace modcal::event {

/// Steps of Newton's method for the nodes of a sliding step, at most.
/// Source: not derived; an end.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kNewtonSteps = 25;

/// Residual of the nodes over what the terms of its equation amount to that is nothing but
/// rounding, the same for the change of the temperature where friction is thermal, and the residual
/// that is taken where a step no longer halves it.
/// Source: some of a double's rounding; two of it; some hundreds.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kTightNodes = 1e-15;
constexpr double kTightThermal = 4e-16;
constexpr double kAcceptableNodes = 1e-13;

/// How many times a sliding step is halved, at most: beyond, none is short enough.
/// Source: 2^-44 = 6e-14 of a grid step is near the rounding of a position.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kDeepestLevel = 44;

/// Length over that of the last step up to which its polynomial is a guess.
/// Source: a step of rounding length, extrapolated over a whole one, started Newton's method at
/// 1e30 m/s.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kFarthestGuess = 16.0;

/// Trials of a step that ends on a switch, at most.
/// Source: not derived; an end, corrections shrink by their square.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kSwitchTrials = 20;

/// Correction of the length, over the step, that is made without another trial.
/// Source: the polynomial of the force errs by its distance from a node: a correction of the share
/// ε adds ε² of what it errs between them.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kLastCorrection = 1e-3;

/// Largest |λ|h [rad] of a power series of the free string, of 22 terms (kSeriesTerms).
/// Source: 1.3²²/22! = 3e-19 of its size is left out.
/// Range tried: this.
/// Doubled: 1e-12 is left out.
/// Halved: 7e-26, in steps half as long.
constexpr double kSlidingPhase = 1.3;

}  // namespace modcal::event
