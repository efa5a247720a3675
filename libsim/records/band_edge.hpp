// Where a recorded band ends: what a digital low-pass leaves above it is no noise of a sensor.
#pragma once

#include <optional>
#include <span>

namespace modcal {

/// A band [of the sampling rate] from which on a record is empty.
struct BandEdge {
  double from = 0.0;   ///< up to 0.435
  double share = 0.0;  ///< most of the power a bin above it has, over the least just below
};

/// The lowest frequency above which, up to 0.475 sampling rates, the medians of the Hann-windowed
/// periodogram over bands of 0.005 sampling rates stay below kEmptyBand of those of the four bands
/// below. Lines stand above a median and hide nothing. None for fewer than kShortestBandRecord
/// samples.
std::optional<BandEdge> find_band_edge(std::span<const double> samples);

}  // namespace modcal
