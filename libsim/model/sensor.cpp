#include "libsim/model/sensor.hpp"

#include <algorithm>
#include <numbers>

#include "libsim/signal/fft.hpp"
#include "libsim/signal/measurement.hpp"

namespace modcal {

SmoothResponse::Place SmoothResponse::place(double omega) const {
  const double last = static_cast<double>(knots.size() - 1);
  const double at = std::min(omega / spacing, last);
  const double below = std::floor(at);
  return {static_cast<std::size_t>(below), at - below};
}

std::complex<double> SmoothResponse::at(double omega) const {
  if (knots.empty()) return 0.0;
  const auto [knot, next] = place(omega);
  if (next == 0.0) return knots[knot];
  return (1.0 - next) * knots[knot] + next * knots[knot + 1];
}

bool SmoothResponse::zero() const {
  return std::all_of(knots.begin(), knots.end(), [](auto knot) { return knot == 0.0; });
}

std::vector<double> Sensor::undone(std::span<const double> samples, double sample_rate) const {
  std::vector<double> result = delay == 0.0 ? std::vector<double>(samples.begin(), samples.end())
                                            : advanced(samples, delay, sample_rate);
  const double half = 0.5 * corner / sample_rate;
  double integral = 0.0, last = 0.0;
  for (double& sample : result) {
    integral += half * (sample + last);
    last = sample;
    sample = (sample + integral) / gain;
  }
  if (smooth.zero()) return result;
  const RealFft fft(result.size());
  std::vector<Complex> spectrum = fft.forward(result);
  const double spacing = 2.0 * std::numbers::pi * sample_rate / static_cast<double>(result.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] *= std::exp(-smooth.at(spacing * static_cast<double>(k)));
  }
  return fft.inverse(spectrum);
}

}  // namespace modcal
