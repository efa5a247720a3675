#include "libinverse/observer/disagreement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/observer/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal::observer {
namespace {

// Bins of a Hann window that stand for one independent value, 35/18 (libinverse/observer/
// observed_record.cpp), over the share of the record under the window.
double bins_per_value(double begin) { return 35.0 / 18.0 / (Reference{}.end - begin); }

// |X_k|² of that part of the record, K/2 + 1 bins.
std::vector<double> windowed_power(std::span<const double> samples, double begin) {
  const auto count = static_cast<double>(samples.size());
  std::vector<double> power;
  for (const Complex bin : hann_spectrum(samples, static_cast<std::size_t>(begin * count),
                                         static_cast<std::size_t>(Reference{}.end * count))) {
    power.push_back(std::norm(bin));
  }
  return power;
}

double mean_of(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

// e of E S_k = e + v_k, Var S_k = (e + v_k)².
void fit_band(std::span<const double> power, std::span<const double> variance, double begin,
              BandError& band) {
  double e = mean_of(power), weight = 0.0;
  for (int iteration = 0; iteration < 30; ++iteration) {
    double sum = 0.0;
    weight = 0.0;
    for (std::size_t k = 0; k < power.size(); ++k) {
      const double spread = e + variance[k];
      if (!(spread > 0.0)) continue;
      const double w = 1.0 / (spread * spread);
      sum += w * (power[k] - variance[k]);
      weight += w;
    }
    const double next = weight > 0.0 ? std::max(0.0, sum / weight) : 0.0;
    const bool settled = std::abs(next - e) <= 1e-6 * e;
    e = next;
    if (settled) break;
  }
  band.square = kSharedNoise * e;
  band.deviation = weight > 0.0 ? std::sqrt(bins_per_value(begin) / weight) : 0.0;
}

}  // namespace

std::vector<BandError> band_errors(std::span<const double> estimate, const Reference& reference) {
  const std::size_t count = estimate.size();
  MODCAL_REQUIRE(count >= 64 && reference.samples.size() == count &&
                     reference.variance.size() == count / 2 + 1,
                 "{} samples are held against {} with {} variances: as many samples are needed, at "
                 "least 64, and the variances of their bins",
                 count, reference.samples.size(), reference.variance.size());
  std::vector<double> difference(count);
  std::ranges::transform(estimate, reference.samples, difference.begin(), std::minus());
  const std::vector<double> power = windowed_power(difference, reference.begin);
  const std::vector<double> own = windowed_power(estimate, reference.begin);
  const double spacing = reference.sample_rate / static_cast<double>(count);
  const double half = 0.49 * reference.sample_rate;
  const double limit =
      std::isnan(reference.band_limit) ? half : std::min(half, 0.98 * reference.band_limit);
  std::vector<BandError> bands;
  double lowest = spacing;
  while (lowest < limit) {
    const double least = lowest + kFewestBins * spacing;
    double highest = std::max({kLowestBand, lowest * std::numbers::sqrt2, least});
    if (highest * 1.2 > limit) highest = limit;
    BandError band{.lowest = lowest, .highest = highest};
    const auto first = static_cast<std::size_t>(std::round(lowest / spacing));
    const std::size_t bins = static_cast<std::size_t>(std::round(highest / spacing)) - first;
    const auto part = [first, bins](std::span<const double> values) {
      return values.subspan(first, bins);
    };
    fit_band(part(power), part(reference.variance), reference.begin, band);
    band.power = mean_of(part(own));
    band.difference = mean_of(part(power));
    bands.push_back(band);
    lowest = highest;
  }
  return bands;
}

std::vector<double> bin_errors(std::span<const double> estimate, std::span<const BandError> bands,
                               double sample_rate, bool trusted) {
  const std::size_t count = estimate.size();
  std::vector<double> errors(count / 2 + 1, 0.0);
  if (bands.empty()) return errors;
  const double spacing = sample_rate / static_cast<double>(count);
  std::size_t k = 1;
  for (const BandError& band : bands) {
    for (; k < errors.size() && static_cast<double>(k) * spacing < band.highest; ++k) {
      errors[k] = band.square;
    }
  }
  const BandError& last = bands.back();
  const double share = trusted && last.power > 0.0 ? std::min(1.0, last.square / last.power) : 1.0;
  if (k < errors.size()) {
    const std::vector<double> own = windowed_power(estimate, Reference{}.begin);
    for (; k < errors.size(); ++k) errors[k] = share * own[k];
  }
  return errors;
}

std::vector<double> with_excess(std::vector<double> errors, const Reference& reference) {
  const double spacing = reference.sample_rate / static_cast<double>(reference.samples.size());
  for (std::size_t k = 0; k < reference.excess.size(); ++k) {
    if (static_cast<double>(k) * spacing > reference.band_limit) break;
    errors[k] = std::max(errors[k], reference.excess[k]);
  }
  return errors;
}

double sample_square(std::span<const double> bins, std::size_t samples) {
  double sum = 0.0;
  for (std::size_t k = 1; k < bins.size(); ++k) sum += 2.0 * bins[k];
  if (samples % 2 == 0 && bins.size() > 1) sum -= bins.back();
  return sum / static_cast<double>(samples);
}

std::vector<double> combined(std::span<const double> estimate, const Reference& reference,
                             std::span<const double> errors, bool beyond) {
  const std::size_t count = estimate.size();
  const RealFft fft(count);
  std::vector<Complex> spectrum = fft.forward(estimate);
  const std::vector<Complex> other = fft.forward(reference.samples);
  const double spacing = reference.sample_rate / static_cast<double>(count);
  spectrum[0] = other[0];
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    if (static_cast<double>(k) * spacing > reference.band_limit) {
      if (!beyond) spectrum[k] = 0.0;
      continue;
    }
    const double both = errors[k] + reference.variance[k];
    const double weight = both > 0.0 ? errors[k] / both : 0.0;
    spectrum[k] += weight * (other[k] - spectrum[k]);
  }
  return fft.inverse(std::move(spectrum));
}

std::vector<double> combined_errors(const Reference& reference, std::span<const double> errors,
                                    bool beyond) {
  const double spacing = reference.sample_rate / static_cast<double>(reference.samples.size());
  std::vector<double> left = with_excess({errors.begin(), errors.end()}, reference);
  for (std::size_t k = 0; k < left.size(); ++k) {
    if (static_cast<double>(k) * spacing > reference.band_limit) {
      if (!beyond) left[k] = 0.0;
      continue;
    }
    const double both = errors[k] + reference.variance[k];
    const double weight = both > 0.0 ? errors[k] / both : 0.0;
    const double excess = reference.excess.empty() ? 0.0 : reference.excess[k];
    left[k] *= (1.0 - weight) * (1.0 - weight);
    left[k] += weight * weight * (reference.variance[k] + excess);
  }
  return left;
}

double estimate_share(const Reference& reference, std::span<const double> errors) {
  const double spacing = reference.sample_rate / static_cast<double>(reference.samples.size());
  double taken = 0.0, all = 0.0;
  for (std::size_t k = 1; k < errors.size(); ++k) {
    if (static_cast<double>(k) * spacing > reference.band_limit) break;
    const double v = reference.variance[k];
    all += v;
    if (v > 0.0) taken += v * v / (errors[k] + v);
  }
  return all > 0.0 ? taken / all : 0.0;
}

}  // namespace modcal::observer
