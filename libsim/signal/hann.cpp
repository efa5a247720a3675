#include "libsim/signal/hann.hpp"

#include <cmath>
#include <numbers>

#include "libsim/signal/statistics.hpp"

namespace modcal {

std::vector<Complex> hann_spectrum(std::span<const double> samples) {
  std::vector<double> windowed(samples.begin(), samples.end());
  remove_mean(windowed);
  double energy = 0.0;
  for (std::size_t j = 0; j < windowed.size(); ++j) {
    const double turn = static_cast<double>(j) / static_cast<double>(windowed.size());
    const double weight = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
    windowed[j] *= weight;
    energy += weight * weight;
  }
  std::vector<Complex> spectrum = RealFft(windowed.size()).forward(windowed);
  const double scale = 1.0 / std::sqrt(energy);
  for (Complex& bin : spectrum) bin *= scale;
  return spectrum;
}

}  // namespace modcal
