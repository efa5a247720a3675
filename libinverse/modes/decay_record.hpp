// A free decay and what is found in it.
#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

namespace modcal {

/// Simultaneous samples of a structure that is left to itself, y_c(t_m), t_m = m/f_s.
struct DecayRecord {
  double sample_rate = 0.0;                   ///< f_s [Hz]
  std::vector<std::vector<double>> channels;  ///< of one length, in any units

  std::size_t samples() const { return channels.empty() ? 0 : channels.front().size(); }
  /// Throws InvalidInput for no channel, lengths that differ, a sample that is not finite, a rate
  /// that is not positive.
  void require_valid() const;
};

/// Pole λ = −ζω + iω√(1 − ζ²) of a free decay.
struct DecayPole {
  double frequency = std::numeric_limits<double>::quiet_NaN();      ///< ω/2π, undamped [Hz]
  double damping_ratio = std::numeric_limits<double>::quiet_NaN();  ///< ζ [1]; < 0: it grows

  static DecayPole of_exponent(std::complex<double> exponent);
  std::complex<double> exponent() const;  ///< λ [1/s]
};

/// A mode of a free decay, y_c(t) = Re(A_c exp(λt)).
struct DecayMode {
  DecayPole pole;
  DecayPole deviation;  ///< standard deviations of f and ζ; NaN where they are not known
  std::vector<std::complex<double>> amplitude;  ///< A_c at the first sample, per channel
};

}  // namespace modcal
