// An inversion problem without bins that are hard to see.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "libsim/base/random.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

inline std::vector<double> noise(std::size_t length, std::uint64_t seed) {
  std::vector<double> samples(length);
  fill_standard_normal(StreamKey(seed), samples);
  return samples;
}

inline double norm(std::span<const double> x) {
  double sum = 0.0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum);
}

/// A problem of any length with |H| in [0.3, 3], where every bin is safe.
struct SafeProblem {
  explicit SafeProblem(std::size_t samples)
      : fft(samples), transfer(fft.bins()), receptance(fft.bins()), force(noise(samples, 1)) {
    const std::vector<double> draw = noise(4 * fft.bins(), 2);
    for (std::size_t k = 0; k < fft.bins(); ++k) {
      transfer[k] = std::polar(std::pow(3.0, std::tanh(draw[4 * k])), draw[4 * k + 1]);
      receptance[k] = Complex{draw[4 * k + 2], draw[4 * k + 3]};
    }
    remove_mean(force);
  }
  /// Response of sampled signals: at K/2 the real part of the transfer function is what shows.
  std::vector<double> response(std::span<const Complex> h) const {
    std::vector<Complex> spectrum = fft.forward(force);
    for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] *= h[k];
    return fft.inverse(spectrum);
  }
  RealFft fft;
  std::vector<Complex> transfer;
  std::vector<Complex> receptance;
  std::vector<double> force;
};

}  // namespace modcal
