// Constants that were tuned, not derived. Records: two strings, 1 s, bowed, three noises of 0.2, 1
// and 5 %, six draws each, at the true model: white noise (W), noise that falls with frequency and
// is alike in both sensors in part (C), white noise and a gain off by 0.05, 0.2 and 2 % (G), 36 of
// each. As they are: no misfit and no spectrum is seen in W, levels to 4.3 %; all spectra of C are
// seen, levels to 29 % in the worst octave; of G 1, 12 and 30 misfits. Body: a resonance of 1.25 %
// in one sensor, 0.1 % of noise (benchmarks/truth).
#pragma once

#include <cstddef>

namespace modcal {

/// Probability under which more than noise is left.
/// Source: one record in 5000 is said to hold a misfit that has none, which costs it the spectrum.
/// Range tried: 5e-5 to 2e-4.
/// Doubled: 13 misfits of 0.2 % in the place of 12.
/// Halved: all as now.
constexpr double kNoiseAlone = 1e-4;

/// Bins below the first knot.
/// Source: 1/f noise of half the power has 50 times its level at 10 Hz, which fewer knots than one
/// an octave down to there take for a misfit.
/// Range tried: 4 to 32.
/// Doubled: 13 misfits of 0.2 %, levels of W to 4.4 %.
/// Halved: all as now.
constexpr std::size_t kLeastBins = 8;

/// Bins of a run that noise does not fill much more than others.
/// Source: a resonance of the body, 10 Hz wide, in a record of a second.
/// Range tried: 8 to 32.
/// Doubled: all as now.
/// Halved: all as now; without the test Body is accepted with an f_n 7 deviations off.
constexpr std::size_t kLump = 16;

/// Fewest bins that tell of the noise.
/// Source: a hundred have a tenth of a level.
/// Range tried: none; every record tried has thousands.
/// Doubled: all as now.
/// Halved: all as now.
constexpr double kFewestBins = 100.0;

/// Bins on either side that the power of the signal is a mean of.
/// Source: two tell of a line and of what stands between lines.
/// Range tried: 1 to 4.
/// Doubled: all as now; the level beside a misfit up to 1.47 of the true one in the place of 1.57.
/// Halved: 13 misfits of 0.2 %; the level beside a misfit up to 1.70.
constexpr std::size_t kAround = 2;

/// Power of the signal over that of the noise under which no misfit shows.
/// Source: a misfit of 2 % has a twenty-fifth of the noise there.
/// Range tried: 50 to 200.
/// Doubled: 13 misfits of 0.2 %, 31 of 2 %.
/// Halved: no misfit of 0.05 %.
constexpr double kLittle = 100.0;

/// Half-widths, and bins, about a mode that are left out; the bins about lines of the mains, too.
/// Source: the fit takes most of the noise of these bins, and what a mode off by its deviation
/// leaves stands in them.
/// Range tried: 2 to 8; 1.5 to 6.
/// Doubled: 0, 12 and 29 misfits; 1, 13 and 27, and one spectrum of C is a misfit.
/// Halved: 6, 16 and 31 misfits; 7, 18 and 36.
constexpr double kWidths = 4.0;
constexpr double kBinsAround = 3.0;

/// The part of the bins, those with least signal, that tells the level beside a misfit.
/// Source: a third has ten thousand bins of a record of a second, three per cent of a level.
/// Range tried: 1.5 to 6.
/// Doubled: the level beside a misfit up to 1.43 of the true one in the place of 1.57.
/// Halved: up to 2.27.
constexpr std::size_t kQuiet = 3;

/// Knots an octave where the noise has a hill that one an octave does not show.
/// Source: noise by numpy with nine times its power about .3 of the Nyquist frequency, .08 wide.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not possible.
constexpr std::size_t kFineKnots = 3;

}  // namespace modcal
