// What the samples of one channel tell against it, whatever was recorded.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace modcal {

/// Samples that no sensor of a vibration has read.
struct SampleFault {
  std::size_t first = 0;  ///< index of the first of them
  std::string text;       ///< value, reason and remedy
};

/// The first that holds of finite samples:
/// - all are equal;
/// - the largest is so large or small that the sum of their squares leaves double precision;
/// - one stands farther beyond the range of all others than that range is wide (from 64 samples);
/// - they pile up at the largest or smallest value: runs of three or more there, and over twice
///   what the roundest top leaves between it and the next value. A sine, whose density is the
///   largest an extreme of a smooth signal has, leaves 1/(√2 − 1) times the samples of the next
///   value; noise and steeper tops leave fewer;
/// - within the signal a run of equal samples is so long that chance leaves one in 10⁹ records:
///   N rⁿ⁻¹ < 10⁻⁹ of n, where the share r of the other neighbors are equal. Where the signal
///   comes and goes by no more than two steps of its resolution it turns, and where it stays so for
///   as long before or behind it is silent.
/// Runs of equal samples at the beginning and at the end are silence, too.
std::optional<SampleFault> find_fault(std::span<const double> samples);

}  // namespace modcal
