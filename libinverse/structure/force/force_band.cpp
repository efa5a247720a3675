#include "libinverse/structure/force/force_band.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "libinverse/structure/tuning.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

double power_outside(const ContourSpectra& spectra, const std::vector<double>& power) {
  const double below = std::max(0.0, static_cast<double>(spectra.bins.first) - 0.5);
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, n = 0.0;
  for (std::size_t m = power.size() / 2; m < power.size(); ++m) {
    const double at = std::log(spectra.s(m).imag()), value = std::log(power[m]);
    x += at, y += value, xx += at * at, xy += at * value, n += 1.0;
  }
  const double spread = xx * n - x * x;
  const double slope = spread > 0.0 ? std::min(0.0, (xy * n - x * y) / spread) : 0.0;
  const double end = (y + slope * (n * std::log(spectra.s(power.size() - 1).imag()) - x)) / n;
  double sum = below * power.front();
  for (std::size_t k = spectra.bins.last; 2 * k < spectra.samples; ++k) {
    sum += std::exp(end + slope * std::log(static_cast<double>(k) /
                                           static_cast<double>(spectra.bins.last - 1)));
  }
  return sum;
}

std::vector<double> power_found(const BinEvidence& evidence) {
  std::vector<double> found;
  for (std::size_t m = 0; m < evidence.told.size(); ++m) {
    const double told = evidence.told[m];
    found.push_back(std::norm(evidence.score[m] / told) - 1.0 / told);
  }
  return found;
}

double rise_towards_zero(const std::vector<double>& power, std::size_t first) {
  const std::size_t count = std::max(first, kFewestRiseBins);
  if (power.size() < 3 * count) return 0.0;
  const auto begin = power.begin(), middle = begin + static_cast<std::ptrdiff_t>(count);
  const double low = std::accumulate(begin, middle, 0.0);
  const double next =
      0.5 * std::accumulate(middle, middle + 2 * static_cast<std::ptrdiff_t>(count), 0.0);
  return low > 0.0 ? low / std::max(next, 1e-300) : 0.0;
}

namespace {

// Largest ln p of the bins' power under A g + noise.
double log_likelihood_of(const std::vector<double>& g, const BinEvidence& evidence) {
  double made = 0.0, shown = 0.0;
  for (std::size_t m = 0; m < g.size(); ++m) {
    made += g[m];
    shown += std::norm(evidence.score[m] / evidence.told[m]);
  }
  double scale = shown / made, result = 0.0;
  // Steps of a square root: 60 leave 1e-9 of what was off.
  for (int step = 0; step < 60; ++step) {
    double up = 0.0, down = 0.0;
    result = 0.0;
    for (std::size_t m = 0; m < g.size(); ++m) {
      const double noise = 1.0 / evidence.told[m], power = scale * g[m] + noise;
      const double seen = std::norm(evidence.score[m] * noise) / power;
      result -= std::log(power) + seen;
      up += g[m] * seen / power;
      down += g[m] / power;
    }
    scale *= std::sqrt(up / down);
  }
  return result;
}

}  // namespace

double log_odds_of_push(const BinEvidence& evidence, const ContourSpectra& spectra,
                        const std::vector<Complex>& pulse) {
  std::vector<double> push, blow;
  for (std::size_t m = 0; m < pulse.size(); ++m) {
    push.push_back(1.0 / std::norm(spectra.s(m)));
    blow.push_back(std::norm(pulse[m]));
  }
  const double odds = log_likelihood_of(push, evidence) - log_likelihood_of(blow, evidence);
  return odds / spectra.correlated();
}

namespace {

// Squared envelope of what stands above a frequency [Hz].
Eigen::VectorXd envelope_above(const Eigen::VectorXd& force, double rate, double low) {
  const auto samples = force.size();
  const RealFft fft(4 * static_cast<std::size_t>(samples));
  std::vector<double> signal(fft.length(), 0.0);
  std::ranges::copy(force, signal.begin());
  std::vector<Complex> spectrum = fft.forward(signal);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    const double at = rate * static_cast<double>(k) / static_cast<double>(fft.length());
    if (at <= low) spectrum[k] = 0.0;
  }
  signal = fft.inverse(spectrum);
  for (Complex& x : spectrum) x *= Complex(0.0, -1.0);
  const std::vector<double> turned = fft.inverse(std::move(spectrum));
  Eigen::VectorXd result(samples);
  for (Eigen::Index j = 0; j < samples; ++j) {
    const auto i = static_cast<std::size_t>(j);
    result[j] = signal[i] * signal[i] + turned[i] * turned[i];
  }
  return result;
}

}  // namespace

Eigen::VectorXd variance_of_shape(const Eigen::VectorXd& force, double rate, double high) {
  return envelope_above(force, rate, high);
}

Eigen::VectorXd variance_about(const Eigen::VectorXd& force, const ContourSpectra& spectra,
                               double outside) {
  const double highest = spectra.s(spectra.count() - 1).imag() / (2.0 * std::numbers::pi);
  const Eigen::VectorXd envelope = envelope_above(force, spectra.sample_rate, 0.5 * highest);
  double weighted = 0.0;
  for (Eigen::Index j = 0; j < envelope.size(); ++j) {
    const double at = static_cast<double>(j) / spectra.sample_rate;
    weighted += envelope[j] * std::exp(-2.0 * spectra.grid.sigma * at);
  }
  // outside is that of noise that lasts as long as the contour weighs it.
  return envelope * (outside * spectra.noise_power() / std::max(weighted, 1e-300));
}

Eigen::VectorXd jackknife(const std::vector<Eigen::VectorXd>& forces) {
  const auto count = static_cast<double>(forces.size());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(forces.front().size()), sum = mean;
  for (const Eigen::VectorXd& force : forces) mean += force / count;
  for (const Eigen::VectorXd& force : forces) sum += (force - mean).cwiseAbs2();
  const double wide = student_quantile(forces.size() - 1) / student_quantile(0);
  return (count - 1.0) / count * wide * wide * sum;
}

}  // namespace modcal
