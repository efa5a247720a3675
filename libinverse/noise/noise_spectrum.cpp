#include "libinverse/noise/noise_spectrum.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {
NoisePair noise_of_residual(const NoiseCovariance& noise, std::complex<double> h1,
                            std::complex<double> h2, std::complex<double> e) {
  const std::complex<double> scaled = e / std::sqrt(noise.of_residual(h1, h2));
  return {scaled * (noise.left * std::conj(h2) - noise.mixed * std::conj(h1)),
          scaled * (noise.mixed * std::conj(h2) - noise.right * std::conj(h1))};
}

NoiseCovariance NoiseSpectrum::at(double frequency) const {
  if (white()) return {};
  const auto next = std::find_if(knots.begin(), knots.end(), [frequency](const Knot& knot) {
    return knot.frequency > frequency;
  });
  if (next == knots.begin()) return knots.front().noise;
  if (next == knots.end()) return knots.back().noise;
  const Knot& last = *(next - 1);
  const double share =
      std::log(frequency / last.frequency) / std::log(next->frequency / last.frequency);
  const NoiseCovariance &a = last.noise, &b = next->noise;
  return {a.left + share * (b.left - a.left), a.right + share * (b.right - a.right),
          a.mixed + share * (b.mixed - a.mixed)};
}

bool NoiseSpectrum::differs_from(const NoiseSpectrum& other, double share) const {
  const auto differ = [&](const Knot& knot) {
    const NoiseCovariance a = at(knot.frequency), b = other.at(knot.frequency);
    return std::abs(a.left - b.left) > share * b.left ||
           std::abs(a.right - b.right) > share * b.right ||
           std::abs(a.mixed - b.mixed) > share * std::sqrt(b.left * b.right);
  };
  return std::any_of(knots.begin(), knots.end(), differ) ||
         std::any_of(other.knots.begin(), other.knots.end(), differ);
}

}  // namespace modcal
