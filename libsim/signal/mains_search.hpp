// Hum of the mains in signals.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "libsim/signal/fft.hpp"

namespace modcal {

/// A line of the signals themselves, and how far from it a line of the mains is not looked for.
struct OwnLine {
  double frequency = 0.0;  ///< [Hz]
  double reach = 0.0;      ///< six bins are added [Hz]
};

/// Power at a frequency of what holds little of the signals themselves, from both spectra there.
using HumPower = std::function<double(double frequency, Complex first, Complex second)>;

/// Lines h F, h = 1 … H, of the mains [Hz]: 8 of them, or as many as stand out, at most 20. F is
/// stated to 0.5 % (`mains` > 0), or looked for so near 50 and 60 Hz (`mains` NaN): it is there if
/// its first or second harmonic stands out, and F maximizes the power of all that do where the
/// first one says, under a Blackman-Harris window (Harris, 1978). To stand out is to have
/// kLineRatio times the median power of the bins about it, away from own lines. mains = 0, or
/// signals of less than 16 periods: none. signals: of one length.
std::vector<double> find_mains(std::array<std::vector<double>, 2> signals, double rate,
                               std::span<const OwnLine> own, HumPower kept, double mains);

}  // namespace modcal
