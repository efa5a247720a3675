// How a sensor reads.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace modcal {

/// Response of one sensor for one that reads the quantity itself,
/// S(s) = gain exp(−s delay) s/(s + corner), s != 0 [1/s]. What two sensors have in common cannot
/// be told from a force that both read: a calibration finds that of x = L against that of x = 0.
struct Sensor {
  /// Its numbers, in the order of values().
  enum Index : std::size_t { kGain, kDelay, kCorner, kCount };

  double gain = 1.0;    ///< > 0 [1]
  double delay = 0.0;   ///< [s]
  double corner = 0.0;  ///< of a high-pass of first order, >= 0 [rad/s]
  bool free = false;    ///< one of its numbers is unknown

  /// The numbers by their index.
  static constexpr double Sensor::*value_of(std::size_t i) {
    constexpr double Sensor::*kValues[kCount] = {&Sensor::gain, &Sensor::delay, &Sensor::corner};
    return kValues[i];
  }
  bool alike() const { return gain == 1.0 && delay == 0.0 && corner == 0.0; }
  /// What comes with a difference (see plain_transients()) is there where there may be one, so that
  /// a search that starts from equal sensors meets no step.
  bool may_differ() const { return free || !alike(); }
  std::complex<double> response(std::complex<double> s) const {
    return gain * std::exp(-s * delay) * s / (s + corner);
  }
  /// ∂ ln S/∂s.
  std::complex<double> rate(std::complex<double> s) const {
    return 1.0 / s - delay - 1.0 / (s + corner);
  }
  /// ∂ ln S by number i: by ln gain, the delay, the corner.
  std::complex<double> slope(std::size_t i, std::complex<double> s) const {
    if (i == kGain) return 1.0;
    return i == kDelay ? -s : -1.0 / (s + corner);
  }
  /// The quantity itself from what the sensor reads, x = y/S: the delay is shifted back (see
  /// advanced()), the high-pass undone as y + corner ∫ y dt by the trapezoidal rule, the bilinear
  /// transform of (s + corner)/s. Throws InvalidInput for a delay longer than the record.
  std::vector<double> undone(std::span<const double> samples, double sample_rate) const;
};

}  // namespace modcal
