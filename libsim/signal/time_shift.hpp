// Shifts a channel in time.
#pragma once

#include <span>
#include <vector>

namespace modcal {

/// x(t_i + delay), band-limited: whole periods by index, the rest by the phase of the spectrum of
/// the record continued by its mirror image (so that it has no jump; the error fades as 1/n² with
/// the distance n from the ends). Instants outside the record repeat its first or last sample.
/// Throws InvalidInput unless |delay| is shorter than the record.
std::vector<double> advanced(std::span<const double> samples, double delay, double sample_rate);

}  // namespace modcal
