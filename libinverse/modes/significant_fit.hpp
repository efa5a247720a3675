// A fit of damped sinusoids without those that are noise.
#pragma once

#include <vector>

#include "libinverse/modes/damped_sinusoid_fit.hpp"

namespace modcal {

/// What χ² of `degrees` of freedom does not reach at any of so many places with a probability of
/// 99.9 %.
double largest_by_chance(std::size_t places, std::size_t degrees);

/// What the departure of any of so many modes does not reach by chance: of 4 terms a channel less
/// the two that the pole, common to the channels, takes.
double least_departure(std::size_t modes, std::size_t channels);

/// fit_damped_sinusoids() with as many poles as the record tells, all of noise but none left out.
/// Taken away are, and the rest is fitted again: those whose evidence is not beyond chance, there
/// being as many places as samples; and one by one those next to a larger one, by less than `reach`
/// [Hz], without which χ² rises by no more. A pole of noise follows the noise to where the fit is
/// best, so that its deviations are too small; it may keep the fit from converging, and shares a
/// mode with its neighbor. With search_residual are added poles_in_residual(), and second poles of
/// modes whose departure is beyond chance, where χ² falls by more than a pole of noise would let
/// it, up to twice the poles that there are at first and kPolesAdded. Noise is that about the pole
/// (ResidualLevels); deviations and departures are of it, too. No modes where none is left.
DampedSinusoidFit fit_significant(const DecayRecord& record, const std::vector<DecayPole>& start,
                                  double reach, bool search_residual,
                                  const DampedSinusoidOptions& options);

}  // namespace modcal
