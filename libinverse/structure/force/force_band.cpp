#include "libinverse/structure/force/force_band.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
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

double power_of_lines_outside(const ContourSpectra& spectra, const std::vector<double>& power) {
  const double highest = spectra.s(power.size() - 1).imag();
  std::vector<double> weights;
  for (std::size_t m = 0; m < power.size(); ++m) {
    weights.push_back(std::max(0.0, power[m]) * std::pow(spectra.s(m).imag() / highest, 2));
  }
  double sum = 0.0, squares = 0.0;
  for (const double w : weights) sum += w, squares += w * w;
  // One line may be all there is, as of a shaker: two have bins between them that are low.
  const double high = 0.1 * std::ranges::max(weights);
  std::size_t lines = 0, low = kBinsBetween;
  for (const double w : weights) {
    if (w > high && low >= kBinsBetween) ++lines;
    low = w > high ? 0 : low + 1;
  }
  const bool are_lines =
      lines > 1 && sum * sum < kFewLines * static_cast<double>(power.size()) * squares;
  const double nyquist = std::numbers::pi * spectra.sample_rate;
  return are_lines ? sum * (1.0 - highest / nyquist) : 0.0;
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
  if (power.size() < 3 * count) return std::numeric_limits<double>::quiet_NaN();
  const auto begin = power.begin(), middle = begin + static_cast<std::ptrdiff_t>(count);
  const double low = std::accumulate(begin, middle, 0.0);
  const double next =
      0.5 * std::accumulate(middle, middle + 2 * static_cast<std::ptrdiff_t>(count), 0.0);
  return low > 0.0 ? low / std::max(next, 1e-300) : 0.0;
}

double peakedness(const Eigen::Ref<const Eigen::VectorXd>& force) {
  const double square = force.array().square().mean();
  return square > 0.0 ? force.array().pow(4).mean() / (square * square) : 0.0;
}

namespace {

// Power A |s|^-2p exp(−(ω/ω_c)^k) + noise of the largest likelihood for what the bins show.
struct PowerFit {
  double log_likelihood = -std::numeric_limits<double>::infinity();
  std::vector<double> power;
};

class PowerShapes {
 public:
  PowerShapes(const BinEvidence& evidence, const ContourSpectra& spectra) : spectra_(spectra) {
    for (const double told : evidence.told) noise_.push_back(1.0 / told);
  }

  // p: 0 of a blow, 1 of a push. Neither a blow's duration is known nor how fast a push changes, so
  // ω_c is free, and k one of those given.
  PowerFit fit(int p, const std::vector<double>& shown, std::span<const double> steepness) const {
    PowerFit best{.power = noise_};
    const double lowest = std::max(spectra_.s(0).imag(), spectra_.grid.spacing);
    const double highest = spectra_.s(noise_.size() - 1).imag();
    const double ratios = std::log(4.0 * highest / (2.0 * lowest)) / std::log(kCutoffRatio);
    for (const double k : steepness) {
      for (int i = 0; i < ratios; ++i) {
        const double cutoff = 4.0 * highest * std::pow(kCutoffRatio, -i);
        PowerFit found = fit_amplitude(shape(p, k, cutoff), shown);
        if (found.log_likelihood > best.log_likelihood) best = std::move(found);
      }
    }
    return best;
  }

 private:
  std::vector<double> shape(int p, double k, double cutoff) const {
    std::vector<double> g(noise_.size());
    for (std::size_t m = 0; m < g.size(); ++m) {
      const Complex s = spectra_.s(m);
      g[m] = std::exp(-std::pow(s.imag() / cutoff, k)) / (p == 0 ? 1.0 : std::norm(s));
    }
    return g;
  }

  // ln A by Fisher's scoring.
  PowerFit fit_amplitude(const std::vector<double>& g, const std::vector<double>& shown) const {
    double amplitude =
        std::accumulate(shown.begin(), shown.end(), 0.0) / std::accumulate(g.begin(), g.end(), 0.0);
    for (int step = 0; step < 20; ++step) {
      double slope = 0.0, information = 0.0;
      for (std::size_t m = 0; m < g.size(); ++m) {
        const double power = amplitude * g[m] + noise_[m], share = amplitude * g[m] / power;
        slope += share * (shown[m] / power - 1.0);
        information += share * share;
      }
      const double change = std::clamp(slope / information, -2.0, 2.0);
      amplitude *= std::exp(change);
      if (std::abs(change) < 1e-3) break;  // its square is left
    }
    PowerFit fit{.log_likelihood = 0.0, .power = std::vector<double>(g.size())};
    for (std::size_t m = 0; m < g.size(); ++m) {
      fit.power[m] = amplitude * g[m] + noise_[m];
      fit.log_likelihood -= std::log(fit.power[m]) + shown[m] / fit.power[m];
    }
    return fit;
  }

  const ContourSpectra& spectra_;
  std::vector<double> noise_;
};

constexpr double kGaussian[] = {2.0}, kAnySteepness[] = {1.0, 2.0, 4.0};

}  // namespace

double log_odds_of_push(const BinEvidence& evidence, const ContourSpectra& spectra) {
  const PowerShapes shapes(evidence, spectra);
  std::vector<double> shown;
  for (std::size_t m = 0; m < evidence.told.size(); ++m) {
    shown.push_back(std::norm(evidence.score[m] / evidence.told[m]));
  }
  const auto odds = [&](const std::vector<double>& power, std::span<const double> steepness) {
    const double push = shapes.fit(1, power, steepness).log_likelihood;
    return (push - shapes.fit(0, power, steepness).log_likelihood) / spectra.correlated();
  };
  // What a push itself would have. Of a Gaussian cutoff alone: with any steepness six of twelve
  // good strikes are not told, as a steep blow is much like the tail of a push.
  const double of_a_push = odds(shapes.fit(1, shown, kGaussian).power, kGaussian);
  return of_a_push < kPushOdds ? std::numeric_limits<double>::quiet_NaN()
                               : odds(shown, kAnySteepness);
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
  const Eigen::VectorXd envelope = envelope_above(force, rate, high);
  const auto reach = static_cast<Eigen::Index>(0.5 * rate / high);
  Eigen::VectorXd result(envelope.size());
  for (Eigen::Index j = 0; j < envelope.size(); ++j) {
    const Eigen::Index first = std::max<Eigen::Index>(0, j - reach);
    const Eigen::Index last = std::min(envelope.size() - 1, j + reach);
    result[j] = envelope.segment(first, last - first + 1).maxCoeff();
  }
  return result;
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
