// Constants of the search for modes in a decay that were set by trial. Records: plucks of violin D
// and G and cello D with a second plane, 1 % of noise (benchmarks/truth/pluck_score.py), all of
// which are accepted.
#pragma once

#include <cstddef>

namespace modcal {

/// Poles of the residual that are fitted at once.
/// Source: a fit of many poles that start badly does not converge.
/// Range tried: 3 to 12, and all that there are: up to a minute where a force has a tail.
/// Doubled: violin D accepted as it is.
/// Halved: violin D accepted as it is.
inline constexpr std::size_t kPolesAdded = 6;

/// How many times the poles that there are at first a search may end with, and kPolesAdded.
/// Source: of 26 modes in two planes the realization may show 8 at first.
/// Range tried: 2 to 6, in 80 decays of strings in two planes.
/// Doubled: as now.
/// Halved: one of these is refused, as so much is left; with 2 six are.
inline constexpr std::size_t kMostOfFirst = 6;

/// By how much χ² may rise on the way to another distance of two poles, three deviations.
/// Source: with two a string's mode of 80 was left 29 deviations off, the truth being allowed by 6.
/// Range tried: 4 to 9, in 80 decays of strings in two planes.
/// Doubled: not tried.
/// Halved: five frequencies and damping ratios of 1700 are farther off than now.
inline constexpr double kFarthestRise = 9.0;

/// Directions in which two poles are taken apart, and steps of a fit at one distance.
/// Source: what is told of them changes over a right angle; a fit starts next to its end.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr int kDirections = 8, kDistanceSteps = 12;

/// Distance of two poles, of the width of the larger, that counts as none.
/// Source: the pair's amplitude is then a straight line in time to a thousandth.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr double kNearestDistance = 0.05;

/// Iterations times poles times samples times channels that the search for poles may take.
/// Source: half a minute of one processor, for records that no few poles tell.
/// Range tried: 1e9 to 4e9, also on 10 s of 11 modes in two planes.
/// Doubled: as now.
/// Halved: as now.
inline constexpr double kSearchCost = 2e9;

/// Variance of what is rounded off at a mode's frequency, over that of white noise, less 1, where
/// noise does not cover the steps.
/// Source: of 48 plucks of 8 and 10 bits, a tenth to a half of the range used, 70 to 84 % of the
/// frequencies and damping ratios lay within 1.96 deviations of white noise.
/// Range tried: 0 and 3.
/// Doubled: deviations a third larger.
/// Halved: a fifth smaller.
inline constexpr double kRoundingExcess = 3.0;

/// Share of a mode's amplitude from which on a third pole tells that the mode changes.
/// Source: noise has poles beside loud modes of up to 0.002; of a glide the third has some percent.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr double kThirdPole = 0.03;

/// How many times as much two poles differ by frequency as by decay, and their share, that tell
/// planes rather than a mode that changes.
/// Source: of 60 gliding strings by numpy (benchmarks/truth/decay_score.py) poles of a mode differ
/// by 1 to 1.4, of strings in two planes by up to 36.
/// Range tried: 1 and 2, by these: with 1 five glides are accepted.
/// Doubled: not tried.
/// Halved: those five.
inline constexpr double kTurnOfTwo = 2.0, kShareOfTwo = 0.1;

/// ln of what a line of the mains may seem to lose of its amplitude along a record without noise.
/// Source: the voltage of the mains keeps within some percent for seconds.
/// Range tried: 0.025 to 0.2, in 214 decays of structures of 0.2 to 1.5 s, 27 of them with hum.
/// Doubled: every hum is found as now, and a mode is lost in five records, in place of four.
/// Halved: as now.
inline constexpr double kSteadyLoss = 0.05;

/// Half the width of a line of the mains as it wanders [Hz].
/// Source: the frequency of a large grid moves by hundredths of a hertz within a minute.
/// Range tried: 0.01 to 0.04 in these records.
/// Doubled: every hum is found as now, and a mode is lost in five records, in place of four.
/// Halved: as now.
inline constexpr double kMainsHalfWidth = 0.02;

/// From which modal assurance criterion on two modes of a structure have one shape, seen by three
/// sensors and more, and by two, of which shapes are alike by chance more often.
/// Source: no pair in 223 decays of linear structures, 4 of 110 pairs nearer than 0.6 half-widths.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr double kOneShape = 0.98, kOneShapeOfTwo = 0.995;

/// Least variance of the noise, over the mean square of the data.
/// Source: rounding of a double squared is 5e-32.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr double kRoundedVariance = 1e-30;

/// Step over the largest pole below which it is rounding, and the last one.
/// Source: without noise the deviations are rounding, too, and no measure of a step.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr double kRoundedStep = 1e-12;

/// Attenuation [dB] of what folds back where a decay is decimated, by Kaiser's formula for the
/// length of the filter.
/// Source: not derived; what folds back is a ten-thousandth.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr double kDecimatorAttenuation = 80.0;

/// Singular value over the largest one below which it is rounding, so that the order of the
/// realization is less than asked.
/// Source: some tens of a double's rounding.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
inline constexpr double kNoSingularValue = 1e-14;

}  // namespace modcal
