// Constants that were tuned, not derived. Records: the plate of benchmarks/truth/plate.py,
// unchanged and changed by 3e-3, four draws each; a plate and a beam that were measured
// (docs/real_measurements.md).
#pragma once

#include <cstddef>
#include <cstdint>

namespace modcal {

/// Over which the force's power and what the sensors contradict each other by are averaged [Hz].
/// Source: wider than a mode, narrower than the band.
/// Range tried: 20 to 80.
/// Doubled: the beam's force is off by .093 (.080), the plates' as before.
/// Halved: by .077; a smooth force on a changed plate has 97.3 % in its band (98.3).
constexpr double kReach = 40.0;

/// Bins below a tenth of the highest that part two lines of a force.
/// Source: on a contour of 2/T a line falls to a tenth within three bins: (σT/2πm)² = .1 at m = 1.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kBinsBetween = 3;

/// Rounds in which the powers of forces at several contacts are found from each other.
/// Source: benchmarks/truth/contacts.py, ten structures, blows and noise at two contacts.
/// Range tried: 1 to 8.
/// Doubled: the errors of all 40 forces are the same to .004.
/// Halved: 39 to .004, one is .541 in the place of .516.
constexpr int kContactRounds = 2;

/// Share of |H|² that is told of an H no larger than its error: a bin without any has no F.
/// Source: six blows on a chain of ten masses, told up to 200 Hz of 450 by two accelerometers: the
/// errors are .16 to .32, all loud samples in a band of ± 1.6 to 2 times the force's rms.
/// Range tried: 1e-5 to 0.1, at which the band is ± 1.1 to 1.7 and 91 % are in it once.
/// Doubled: ± 1.4 to 1.9, all in it.
/// Halved: ± 2 to 2.3, all in it.
constexpr double kLeastKnown = 0.01;

/// Share of the bins below which the participation ratio of a force's power is that of few lines.
/// Source: sawtooth forces with 2.5 to 12 harmonics in the band on eight structures, two sensors:
/// 87 to 100 % of the samples are in the band; forces of noise are as they were.
/// Range tried: 0.05 to 0.2.
/// Doubled: as now but for one, 94.7 % in the place of 93.1; forces of noise 99.9 for 99.5 % once.
/// Halved: one force of six harmonics holds 69 % in the place of 91.
constexpr double kFewLines = 0.1;

/// Over which a measured |H|² is averaged, so that an antiresonance is as uncertain as its flanks
/// [Hz].
/// Source: that of the weights of a strike's bins.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kFlank = 3.0;

/// How many times as fine as measured lines the spectrum of an impulse response is, and how many
/// points of it Lagrange's polynomial takes: the phase turns by π/8 a point at most, and the
/// remainder is (π/8)^8 (1/2 3/2 5/2 7/2)²/8! = 6e-7 of the largest.
/// Source: that bound.
/// Range tried: these.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kFine = 8;
constexpr int kPoints = 8;

/// rise_towards_zero() from which a force has a slow part below its band.
/// Source: a bowed bar by two accelerometers, bands from 0.1 to 50 Hz on, has 11 to 271, begun at
/// once 3.1 to 183 and once 0.5; of 18 forces of 15 to 300 Hz on a plate 17 have at most 1.1.
/// Range tried: 1.5 to 6.
/// Doubled: two more of those begun at once are only warned of.
/// Halved: the eighteenth on the plate, 2.6 and right, is rejected.
constexpr double kRise = 3.0;

/// Bins that rise_towards_zero() averages over at least.
/// Source: the mean of 16 powers of noise scatters by a quarter.
/// Range tried: 16.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kFewestRiseBins = 16;

/// Rounds in which what rang before a record, the force's power and the sensors' variances are
/// found.
/// Source: the force changes by less than its deviation's hundredth after three.
/// Range tried: 3 to 6.
/// Doubled: as above.
/// Halved: not tried.
constexpr int kStateRounds = 3;

/// Sweeps of automatic relevance determination at most.
/// Source: it ends before where its evidence stays.
/// Range tried: 75 to 300.
/// Doubled: no force changes in three digits.
/// Halved: none.
constexpr int kMostSweeps = 150;

/// Pairs of poles on a grid whose gain a step of the search of modes finds exactly.
/// Source: where all are, the plate and the beam have as many modes and a BIC less by 0.5 and 0.
/// Range tried: 48, 200 and all.
/// Doubled: four times as many find the same modes.
/// Halved: not tried.
constexpr std::ptrdiff_t kExactGains = 48;

/// So many numbers may that grid have where it can look at fewer strikes: 400 MB.
/// Source: five strikes of the plate have 3e7. Four sessions of response functions of 1180 lines,
/// 3e8 numbers, took 2.2 GB and 60 s; by the first one alone .6 GB and 16 s, with all true modes.
/// Range tried: all of 2 to 5 strikes, and the first alone, by which five of 24 sets of strikes
/// that differ by 3e-3 lose a mode.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kGridNumbers = 5e7;

/// Damping ratios between which a search of modes stays.
/// Source: what is damped less rings longer than any record of its bandwidth; more is no mode.
/// Range tried: these.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kLeastDampingRatio = 1e-5, kMostDampingRatio = 0.5;

/// Share of the responses, an amplitude, that sensors contradict each other by where the answer is
/// doubted.
/// Source: more than a table of another day leaves, .06 of the plate that changed by 3e-3.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kContradiction = 0.1;

/// Of a StructureChange whose size is found, over the sizes that it has by default: where the
/// search begins, the least and the most, at which what differs is not the structure. Source: 42
/// forces on five simulated structures whose frequencies changed by 1 %, all alike or each by
/// itself: found are .7 to 1.3 of that and 0 in the constants; 97.5 % and more in the band. Of
/// sensors exchanged, late, of another sign or unit, and of other contacts, 18 records, constants
/// are off by 15 % and more; a gain of 1.1 of one sensor by 2 to 3 %.
/// Range tried: the most up to 3 in frequencies, 6 in constants.
/// Doubled: of 21 changes by 3 %, refused as it is, two have blows outside of the band.
/// Halved: changes by 1 % are refused. The least and the first size change no answer.
constexpr double kFirstChange = 0.3, kLeastChange = 0.01, kMostChange = 2.0;

/// By how much more than the others a sensor of a structure that has changed may read all modes.
/// Source: gains of 1.4 and 1.5 of two of four accelerometers on the plate, which a change of
/// constants of 8 to 10 % had taken up: .17 and more. One gain of 1.1 is .075.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kOtherGain = 0.1;

/// Deviations that a force beside others exceeds at one instant at least, or none is told there.
/// Source: eight blows at one of two contacts (benchmarks/truth/contacts.py) exceed 3.2 and more of
/// their deviations, of which the pulse's shape is most, and nothing at the other one 1.2 at most.
/// Range tried: 1.25 to 5.
/// Doubled: four of the eight blows are not told.
/// Halved: as it is.
constexpr double kToldBeside = 2.5;

/// Share of the responses, an amplitude, that sensors contradict forces at several contacts by
/// where they are refused, if it is kBeyond times as much as expected, too.
/// Source: benchmarks/truth/contacts.py, two contacts and four sensors: of 49 right answers those
/// that are beyond leave up to .047, of 24 for a force that acts elsewhere all .078 and more.
/// Range tried: 0.03 to 0.12.
/// Doubled: five of those 24 are accepted.
/// Halved: six of the 49 are refused.
constexpr double kContradictionOfContacts = 0.06;

/// Share of the responses, an amplitude, and how many times as much as expected, that sensors
/// contradict each other by where the structure may have changed.
/// Source: those structures. Unchanged they leave up to .01; changed by 3e-3 .01 to .06, a smooth
/// force has 91 to 99 % in its band as the table is, 97 to 100 % where the modes are refined.
/// Range tried: 0.02; 2.
/// Doubled: not tried.
/// Halved: not tried; changes by 1e-3 have 96 % and more in the band as they are.
constexpr double kChanged = 0.02, kBeyond = 2.0;

/// Mean square over what is expected that the other sensors leave where one alone contradicts them.
/// Source: one of four with a gain of 1.3 or 2, a delay, samples dropped, another sign or noise
/// leaves .001 to .044; 79 of 80 plates of which all sensors had changed (by .03 to .3) .10 and up.
/// Range tried: 0.1 and 0.25.
/// Doubled: one more of the 80 loses a sensor that was as good as the others; at 0.25 two more.
/// Halved: not tried.
constexpr double kAgreement = 0.1;

/// Share of a force's peak below which it is over.
/// Source: a smooth force by all of a record of 2 s (plate) and 8 s (beam) stays below .03 of it
/// after the blows; the plate's rebound has .6.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kLoud = 0.1;

/// Share of a record in which it is looked for when the force is over, as behind it the record's
/// end looks like a force, and how many times as large as in as much before a response is behind it
/// where something strikes there.
/// Source: noise of a record of which an instrument's window was taken out rises by e^.7 at most.
/// By what looks like a force instead (half of the peak and more) most strikes on plates that
/// changed by 3e-3 kept all of their record, off by .39 in the place of .07.
/// Range tried: these.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kSeen = 0.9, kLate = 2.5;

/// The share that is looked at by measured functions, which do not tell what the end cuts off.
/// Source: of the strike on a measured plate a sixth of 2 s at the end is off by three deviations:
/// all was kept, off by .38 with 15 % in the band; .03 and all in it now.
/// Range tried: 0.5 to 0.9, at which all of 2 s is kept again.
/// Doubled: not possible.
/// Halved: not tried.
constexpr double kSeenByFunctions = 0.8;

/// By lines that are finer a window goes on for no longer than so many periods of the band's width,
/// half a period of the mean spacing of 40 modes: lines half a hertz apart asked for a second.
/// Source: that plate has 28 modes in its band; of more than 40 state a window.
/// Range tried: 10 to 40.
/// Doubled: the plate's force is off by .040 in the place of .031, that on a chain of ten masses as
/// now. Halved: .069.
constexpr double kLongestSpacing = 20.0;

/// So many 1/σ are looked at where functions of an exponential window weigh the record.
/// Source: e^4 = 55 times the noise at the end, which is less than the peak.
/// Range tried: 4 and 12, by which noise of a record that is quiet at its end passes for 9 kN.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kSeenWeighted = 4.0;

/// So many 1/σ a window lasts at most where the record is weighted by exp(−σt).
/// Source: 6e-6 of what acts at its end is left.
/// Range tried: 40 to 120, by which a plate's force is off by 1e14 to 1e48 of itself.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kLongestWeighted = 12.0;

/// Instants of pulses that a window holds at most.
/// Source: matrices of 128 MB.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kMostInstants = 4000.0;

/// Instants of pulses up to which they are tried whatever the smooth force looks like.
/// Source: that takes a second; 3500 take 90.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr double kFewInstants = 1000.0;

/// Sensors from which on what pulls a mode apart is told from noise, by the deviation alone.
/// Source: 36 simulated structures, 7 of them with modes that were merged: those are pulled apart
/// by 1 to 2.2 of their deviations, 9 of 10 others by less than .6. Two sensors pull a mode apart
/// by noise alone as far as that once in three times. Range tried: this. Doubled: not tried.
/// Halved: not possible.
constexpr std::size_t kFewestThatPull = 3;

/// Deviation of a mode's frequency from which it may be none of the structure's, in half-widths ζf.
/// Source: 34 simulated structures of 2 to 25 modes: of 344 modes in the band 28 are none of
/// theirs, of which 8 are told better than this, as are 305 of 316 true ones.
/// Range tried: a sixth to one.
/// Doubled: 20 and 314.
/// Halved: 5 and 292.
constexpr double kToldWidth = 1.0 / 3.0;

/// ln of the odds over blows from which what pulses explain is a push, and that a push itself must
/// have to be told.
/// Source: 40 strikes on simulated structures (benchmarks/truth/structures.py) have -152 to -2.2,
/// 80 pushes that are let go or set in 6.2 and more, or are not told by a single accelerometer. 18
/// strikes on a plate by response functions, which tell nothing of a pulse, have -11 to -6.
/// Range tried: 1.5 to 6, by these.
/// Doubled: two of the strikes are not told from a push, and rejected; all pushes are.
/// Halved: as it is.
constexpr double kPushOdds = 3.0;

/// From one cutoff of a push's or a blow's spectrum that is tried to the next.
/// Source: those strikes and pushes.
/// Range tried: 1.4 to 3.4.
/// Doubled: one push of 80 is accepted, another one warned of.
/// Halved: no ratio; 1.4 has odds of 4.2 in the place of 6.2 at least, and the same answers.
constexpr double kCutoffRatio = 1.7;

/// Share of a column that is its own beside those before it, from which the square of the columns
/// tells what they span.
/// Source: rounding. The basis is orthonormal to ε over the square of it, 2e-8, and what is taken
/// out twice is out to the square of that.
/// Range tried: 1e-6 to 1e-1, the last of which takes the longer way always: the same answers to
/// 1e-9.
/// Doubled: as it is.
/// Halved: as it is.
constexpr double kOwnOfColumn = 1e-4;

/// Fourth moment of a smooth force over the square of its second from which on it is one of blows.
/// Source: eight structures of 5 to 22 modes: random forces, chirps, saw-teeth and pushes of .6 to
/// 4 s have 1.6 to 5.2, trains of blows 250 and more; steps, of which accelerometers see the edge
/// and whose answer is wrong, 6.4 to 58. Range tried: 6 to 200, by these numbers. Doubled: one
/// wrong answer to a step is rejected as now. Halved: a push is taken for blows.
constexpr double kPeaked = 10.0;

}  // namespace modcal
