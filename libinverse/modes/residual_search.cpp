#include "libinverse/modes/residual_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/turn.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {
namespace {

struct Place {
  double evidence = 0.0;
  double decay = 0.0;  // d [1/s]
};

// Of a decay rate: what χ² would fall by at every frequency. The larger is kept.
class Scan {
 public:
  Scan(const DampedSinusoidFit& fit, const ResidualLevels& levels, double rate,
       double in_band_variance)
      : fit_(fit), rate_(rate), fft_(2 * fit.residual.front().size()), places_(fft_.bins()) {
    for (std::size_t c = 0; c < fit.residual.size(); ++c) {
      std::vector<double>& weights = weights_.emplace_back();
      for (std::size_t k = 0; k < fft_.bins(); ++k) {
        weights.push_back(
            2.0 / (in_band_variance * fit.noise[c] * fit.noise[c] * levels.at(c, frequency(k))));
      }
    }
  }

  double frequency(std::size_t bin) const {
    return static_cast<double>(bin) * rate_ / static_cast<double>(fft_.length());
  }
  const std::vector<Place>& places() const { return places_; }

  void add(double decay) {
    const std::size_t samples = fit_.residual.front().size();
    std::vector<double> envelope(samples), weighted(fft_.length(), 0.0);
    double power = 0.0;
    for (std::size_t m = 0; m < samples; ++m) {
      envelope[m] = std::exp(-decay * static_cast<double>(m) / rate_);
      power += envelope[m] * envelope[m];
    }
    std::vector<double> evidence(fft_.bins(), 0.0);
    for (std::size_t c = 0; c < fit_.residual.size(); ++c) {
      for (std::size_t m = 0; m < samples; ++m) weighted[m] = envelope[m] * fit_.residual[c][m];
      const std::vector<Complex> spectrum = fft_.forward(weighted);
      for (std::size_t k = 0; k < evidence.size(); ++k) {
        evidence[k] += weights_[c][k] * std::norm(spectrum[k]) / power;
      }
    }
    for (std::size_t k = 0; k < evidence.size(); ++k) {
      if (evidence[k] > places_[k].evidence) places_[k] = {evidence[k], decay};
    }
  }

 private:
  const DampedSinusoidFit& fit_;
  double rate_;
  RealFft fft_;
  std::vector<Place> places_;
  std::vector<std::vector<double>> weights_;  // of each channel's bins
};

}  // namespace

ResidualLevels::ResidualLevels(const DecayRecord& record, const DampedSinusoidFit& fit,
                               double in_band_variance) {
  const std::size_t samples = fit.residual.front().size();
  // The median of 129 bins tells a level to 11 %, and deviations to 5 %.
  constexpr std::size_t kBins = 64, step = kBins / 4;
  spacing_ = static_cast<double>(step) * record.sample_rate / static_cast<double>(samples);
  for (std::size_t c = 0; c < fit.residual.size(); ++c) {
    const std::vector<Complex> spectrum = hann_spectrum(fit.residual[c], samples / 2, samples);
    // The median of an exponential distribution is ln 2 of its mean.
    const double white = std::numbers::ln2 * in_band_variance * fit.noise[c] * fit.noise[c];
    const double rounded = record.rounding.empty() ? 1.0 : record.rounding[c];
    std::vector<double>& levels = levels_.emplace_back();
    for (std::size_t k = 0; k < spectrum.size(); k += step) {
      std::vector<double> power;
      for (std::size_t i = k - std::min(k, kBins); i < std::min(k + kBins + 1, spectrum.size());
           ++i) {
        power.push_back(std::norm(spectrum[i]));
      }
      const auto middle = power.begin() + static_cast<std::ptrdiff_t>(power.size() / 2);
      std::ranges::nth_element(power, middle);
      levels.push_back(rounded * (white > 0.0 ? std::max(1.0, *middle / white) : 1.0));
    }
  }
}

double ResidualLevels::at(std::size_t channel, double frequency) const {
  const std::vector<double>& levels = levels_[channel];
  const auto nearest = static_cast<std::size_t>(std::max(0.0, std::round(frequency / spacing_)));
  return levels[std::min(nearest, levels.size() - 1)];
}

double ResidualLevels::largest(double frequency) const {
  double level = 1.0;
  for (std::size_t c = 0; c < levels_.size(); ++c) level = std::max(level, at(c, frequency));
  return level;
}

std::vector<DecayPole> poles_in_residual(const DampedSinusoidFit& fit, const ResidualLevels& levels,
                                         double sample_rate, double in_band_variance,
                                         double least) {
  const double duration = static_cast<double>(fit.residual.front().size()) / sample_rate;
  Scan scan(fit, levels, sample_rate, in_band_variance);
  const auto octaves = static_cast<int>(std::log2(0.1 * std::numbers::pi * sample_rate * duration));
  for (int octave = 0; octave <= octaves; ++octave) scan.add(std::exp2(octave) / duration);
  // Two of its bins are a wave over the record: what is slower has no frequency.
  const std::vector<Place>& places = scan.places();
  std::vector<std::size_t> order;
  for (std::size_t k = 2; k + 2 < places.size(); ++k) {
    if (places[k].evidence > least) order.push_back(k);
  }
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t k) { return places[k].evidence; });
  std::vector<DecayPole> found;
  for (const std::size_t k : order) {
    const double decay = places[k].decay;
    const bool is_new = std::ranges::none_of(found, [&](const DecayPole& louder) {
      const double width = std::max(decay, -louder.exponent().real()) / kTurn + 1.0 / duration;
      return std::abs(louder.frequency - scan.frequency(k)) < width;
    });
    if (is_new) found.push_back(DecayPole::of_exponent({-decay, kTurn * scan.frequency(k)}));
  }
  return found;
}

}  // namespace modcal
