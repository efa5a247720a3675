// Constants that were tuned, not derived. Counts are starts of 54 of NIST's certified problems that
// end with six digits (benchmarks/nist), evaluations their sums.
#pragma once

namespace modcal {

/// A quasi-Newton search of NLopt that ended starts afresh if it lowered the value by this
/// share.
/// Source: benchmarks/nist, where searches that go wrong stop decades above the minimum.
/// Range tried: 0.05 to 0.2.
/// Doubled: SLSQP 52, L-BFGS 35, with 19 778 and 8 059 evaluations, all as they are now.
/// Halved: 52 and 35, with 19 799 and 8 059 evaluations.
constexpr double kFreshStartGain = 0.1;

/// Small decreases in a row that end a least-squares search or a descent.
/// Source: benchmarks/nist; of ENSO's digits one small decrease leaves 5.9, two leave 6.1.
/// Range tried: 1 to 4.
/// Doubled: Ceres 53, GSL lm 51, as now, with 1 and 2 % more evaluations; ENSO to 6.5 digits.
/// Halved: Ceres 51, GSL lm 49, with 2 and 4 % fewer evaluations.
constexpr int kSmallDecreasesInARow = 2;

/// How far inside its bounds a variable starts in an unbounded search, of the width of its
/// range: on the bound itself the map has no slope.
/// Source: a quadratic in [-5, 5] started on a bound; runs with vector_bfgs2 57, nmsimplex2 135
/// evaluations.
/// Range tried: 0.0005 to 0.002.
/// Doubled: 64 and 139 evaluations; vector_bfgs2 to 9e-10 in the place of 5e-13.
/// Halved: 56 and 124 evaluations; nmsimplex2 to 1e-7 in the place of 9e-9.
constexpr double kInsideBounds = 0.001;

/// Accuracy of GSL's line searches along a descent.
/// Source: the library's manual recommends it. Starts of conjugate_fr 26, conjugate_pr 28,
/// vector_bfgs 26, vector_bfgs2 28, the last with 198 000 evaluations.
/// Range tried: 0.05 to 0.2.
/// Doubled: 23, 25, 28 and 29, the last with 262 000 evaluations.
/// Halved: 26, 26, 25 and 30, the last with 279 000 evaluations.
constexpr double kGslLineTolerance = 0.1;

/// Iterations without a step after which a search along a line ends. Near a minimum values
/// differ by less than rounding within √ε of it: the bracket may stay wide.
/// Source: 20 cosines; brent 28 and golden_section 55 evaluations each, to 1.5e-8 and 9e-6 at
/// worst.
/// Range tried: 6 to 24.
/// Doubled: 40 and 56 evaluations, to 1.5e-8 and 4e-8.
/// Halved: 22 and 37 evaluations, to 1.5e-8 and 2.5e-2.
constexpr int kRestingSteps = 12;

/// Damping above which tiny_least_squares gives up: steps are then below rounding. It grows by
/// powers of 2 whose exponents add up, so that halving and doubling mean that of its exponent.
/// Source: benchmarks/nist.
/// Range tried: 1e10 to 1e40.
/// Doubled: starts 50, as now, with as many evaluations.
/// Halved: the same.
constexpr double kHopelessDamping = 1e20;

/// A variable whose answer moved by less than this share of a step between two searches is
/// settled.
/// Source: chains of 30 variables with couplings 0.1, 0.3 and 0.6, of whose 300 searches 152,
/// 105 and 11 are left out.
/// Range tried: 0.05 to 0.2.
/// Doubled: the same, to the last digit.
/// Halved: the same, to the last digit.
constexpr double kUnmovedSteps = 0.1;

/// How many steps another variable may have moved before a settled one is searched again.
/// Variables are moved by half steps: one step or less, whatever the rounding.
/// Source: the same chains.
/// Range tried: 0.6 to 2.5.
/// Doubled: 139, 108 and 17 searches are left out, and the strongest chain ends 7 % higher.
/// Halved: 147, 99 and 7 are left out, and no chain ends higher than with all searches.
constexpr double kReachingSteps = 1.25;

// Twelve records of benchmarks/truth (T): libcalib/identifiability/tuning.hpp.

/// Deviations from which a step is long: it is likely to be taken, and the information needed where
/// it ends.
/// Source: a step of one deviation changes what a column is.
/// Range tried: 0.5 to 2, on T.
/// Doubled: no f_n moves by 0.01 sd.
/// Halved: none does.
constexpr double kLongStep = 1.0;

/// Deviations by which a variable moved less keeps its row of the information. Even where a column
/// is another one after a deviation, a step is then off by a twenty-fifth of one, and the slope,
/// which is exact, has the next step make up for it.
/// Source: as above.
/// Range tried: 0.1 to 0.4, on T.
/// Doubled: no f_n moves by 0.01 sd.
/// Halved: by up to 0.02 sd.
constexpr double kMovedDeviations = 0.2;

}  // namespace modcal
