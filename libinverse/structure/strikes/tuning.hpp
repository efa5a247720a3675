// Constants of the noise of a measured force, and of modes that may be two, that were set by trial.
#pragma once

#include <cstddef>
#include <cstdint>

namespace modcal {

/// Draws of force noise by which its share that a fit's columns take up is counted.
/// Source: a draw has some hundred bins, eight of them tell the share to a tenth.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::uint64_t kForceNoiseDraws = 8;

/// Parts of a force's record of which a quarter and more is taken to be quiet, and their deviation
/// over the force's peak from which on it acts all the time.
/// Source: a blow lasts a hundredth of its record, and has a thousandth of its peak in noise; of
/// random and stepped forces a quarter of a peak is left in every part.
/// Range tried: this.
/// Doubled: not tried.
/// Halved: not tried.
constexpr std::size_t kQuietParts = 20;
constexpr double kQuietShare = 0.02;

/// Half-widths about a mode, on the contour, in whose bins two modes are tried in its place, and
/// steps of their fit at most.
/// Source: two modes that are taken for one stand within five half-widths.
/// Range tried: 8; 12 and 30 steps.
/// Doubled: of 365 structures with a close pair as many pairs are parted, within one.
/// Halved: not tried.
constexpr double kReachOfPair = 8.0;
constexpr int kPairSteps = 12;

/// What a fit is asked of a contour of a finer σ: over that of the fit, and of the record's length
/// at least.
/// Source: at 5/T the amplitude that is left at the record's end is a hundredth.
/// Range tried: these.
/// Doubled: not tried.
/// Halved: not tried.
constexpr int kLateSteps = 4;
constexpr double kLateContour = 0.25, kLeastLate = 4.0;

}  // namespace modcal
