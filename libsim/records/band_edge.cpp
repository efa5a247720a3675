#include "libsim/records/band_edge.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libsim/records/tuning.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// Hundredths of half the sampling rate.
constexpr std::size_t kBands = 95, kLastEdge = 85, kBelow = 4, kBetween = 2;

std::vector<double> medians_of(std::span<const double> samples) {
  const std::vector<Complex> spectrum = hann_spectrum(samples);
  const double width = static_cast<double>(spectrum.size() - 1) / 100.0;
  std::vector<double> medians;
  for (std::size_t band = 0; band < kBands; ++band) {
    std::vector<double> power;
    const auto end = static_cast<std::size_t>(width * static_cast<double>(band + 1));
    for (auto k = static_cast<std::size_t>(width * static_cast<double>(band)); k < end; ++k) {
      power.push_back(std::norm(spectrum[k]));
    }
    medians.push_back(quantile(std::move(power), 0.5));
  }
  return medians;
}

}  // namespace

std::optional<BandEdge> find_band_edge(std::span<const double> samples) {
  if (samples.size() < kShortestBandRecord) return std::nullopt;
  const std::vector<double> medians = medians_of(samples);
  // The lowest bands hold drift and what a high-pass leaves.
  for (std::size_t band = 2 * kBelow; band <= kLastEdge; ++band) {
    const auto at = medians.begin() + static_cast<std::ptrdiff_t>(band);
    const double below = *std::min_element(at - kBelow, at);
    const double above = *std::max_element(at + kBetween, medians.end());
    if (above < kEmptyBand * below) {
      return BandEdge{0.005 * static_cast<double>(band + kBetween), above / below};
    }
  }
  return std::nullopt;
}

}  // namespace modcal
