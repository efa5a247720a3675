// How a sensor reads.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace modcal {

/// A function of ω that is linear between knots at ω = k·spacing, k = 0, 1, …, and constant above
/// the last.
struct SmoothResponse {
  std::vector<std::complex<double>> knots;
  double spacing = 0.0;  ///< > 0 where there are knots [rad/s]

  /// The knot at or below ω >= 0, and the share of the next one there, in [0, 1).
  struct Place {
    std::size_t knot = 0;
    double next = 0.0;
  };
  Place place(double omega) const;
  std::complex<double> at(double omega) const;  ///< 0 without knots
  bool zero() const;
};

/// Response of one sensor for one that reads the quantity itself,
/// S(s) = gain exp(−s delay) s/(s + corner) exp(smooth(Im s)), s != 0 [1/s]. What two sensors have
/// in common cannot be told from a force that both read: a calibration finds that of x = L against
/// that of x = 0.
struct Sensor {
  /// Its numbers, in the order of values().
  enum Index : std::size_t { kGain, kDelay, kCorner, kCount };

  double gain = 1.0;    ///< > 0 [1]
  double delay = 0.0;   ///< [s]
  double corner = 0.0;  ///< of a high-pass of first order, >= 0 [rad/s]
  bool free = false;    ///< one of its numbers is unknown
  SmoothResponse smooth = {};

  /// The numbers by their index.
  static constexpr double Sensor::*value_of(std::size_t i) {
    constexpr double Sensor::*kValues[kCount] = {&Sensor::gain, &Sensor::delay, &Sensor::corner};
    return kValues[i];
  }
  bool alike() const { return gain == 1.0 && delay == 0.0 && corner == 0.0 && smooth.zero(); }
  /// What comes with a difference (see plain_transients()) is there where there may be one, so that
  /// a search that starts from equal sensors meets no step.
  bool may_differ() const { return free || !alike(); }
  std::complex<double> response(std::complex<double> s) const {
    const std::complex<double> known = gain * std::exp(-s * delay) * s / (s + corner);
    return smooth.knots.empty() ? known : known * std::exp(smooth.at(std::abs(s.imag())));
  }
  /// ∂ ln S/∂s, but for `smooth`, which changes little where the others do not.
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
  /// transform of (s + corner)/s, `smooth` in the bins of the record. Throws InvalidInput for a
  /// delay longer than the record.
  std::vector<double> undone(std::span<const double> samples, double sample_rate) const;
};

}  // namespace modcal
