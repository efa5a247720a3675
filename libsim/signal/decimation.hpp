// The anti-alias filter of a recorder.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace modcal {

/// Samples of the result that the filter reaches at either side: (A − 8)/(2 · 2.285 · 0.4π) of
/// Kaiser's window for A = 80 dB over a fifth of the sample rate (Oppenheim and Schafer, 2010).
constexpr std::size_t decimation_reach() { return 13; }

/// Every step-th sample of what a low-pass without delay leaves of a signal that is 0 before it
/// begins: a sinc under Kaiser's window, flat to 0.4 sample rates of the result and 80 dB down from
/// 0.6 on, so that nothing is folded below 0.4. As many
/// samples as the filter has all of the signal for: none where it is shorter than its reach. step
/// 1: the signal as it is.
std::vector<double> decimated(std::span<const double> samples, std::size_t step);

}  // namespace modcal
