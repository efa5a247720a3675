#include "libinverse/structure/structure_record.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "libsim/base/error.hpp"
#include "libsim/base/turn.hpp"

namespace modcal {
namespace {

// weights: exp(−σt_j) at every sample.
std::vector<Complex> spectrum_of(std::span<const double> samples, const ContourSpectra& at,
                                 std::span<const double> weights, const RealFft& fft,
                                 const std::string& name) {
  MODCAL_REQUIRE(samples.size() == at.samples,
                 "{} has {} samples, the first response {}: state signals of one record", name,
                 samples.size(), at.samples);
  std::vector<double> weighted(samples.begin(), samples.end());
  for (std::size_t j = 0; j < weighted.size(); ++j) {
    MODCAL_REQUIRE(std::isfinite(weighted[j]), "sample {} of {} is {}: take it out of the record",
                   j, name, weighted[j]);
    weighted[j] *= weights[j];
  }
  const std::vector<Complex> all = fft.forward(weighted);
  return {all.begin() + static_cast<std::ptrdiff_t>(at.bins.first),
          all.begin() + static_cast<std::ptrdiff_t>(at.bins.last)};
}

}  // namespace

ContourSpectra ContourSpectra::of(const StructureRecord& record, double sigma, double low,
                                  double high) {
  MODCAL_REQUIRE(!record.responses.empty(), "a record needs at least {} response", 1);
  MODCAL_REQUIRE(sigma >= 0.0, "a contour at {:g} 1/s lies left of the axis: state 0 or more",
                 sigma);
  ContourSpectra result{.sample_rate = record.sample_rate, .samples = record.samples()};
  result.grid = FrequencyGrid::of_record(result.samples, result.sample_rate);
  result.grid.sigma = sigma;
  result.bins = bins_between(result.grid, kTurn * low, kTurn * high);
  // On a contour the mean is one more bin, which reaches to half of the spacing.
  if (sigma > 0.0 && kTurn * low < 0.5 * result.grid.spacing) result.bins.first = 0;
  MODCAL_REQUIRE(result.count() > 0 && high < 0.5 * record.sample_rate,
                 "no bin of the record lies from {:g} Hz to {:g} Hz, below half its rate {:g} Hz",
                 low, high, record.sample_rate);
  const RealFft fft(result.samples);
  std::vector<double> weights(result.samples);
  for (std::size_t j = 0; j < weights.size(); ++j) {
    weights[j] = std::exp(-sigma * static_cast<double>(j) / record.sample_rate);
  }
  if (!record.force.empty()) {
    result.force = spectrum_of(record.force, result, weights, fft, "the force");
  }
  for (std::size_t k = 0; k < record.responses.size(); ++k) {
    result.responses.push_back(
        spectrum_of(record.responses[k], result, weights, fft, fmt::format("response {}", k + 1)));
  }
  return result;
}

double ContourSpectra::noise_power() const {
  const double step = 2.0 * grid.sigma / sample_rate, count = static_cast<double>(samples);
  return step > 0.0 ? -std::expm1(-step * count) / -std::expm1(-step) : count;
}

// As a signal of the record's duration, so many samples that its band and what the weights add to
// either side of it fit in; times the weights at its instants.
BinCorrelation::BinCorrelation(const ContourSpectra& spectra)
    : first_(spectra.bins.first), weights_(4 * (first_ + spectra.count())) {
  const auto count = static_cast<double>(weights_.size());
  double sum = 0.0, j = 0.0;
  for (double& weight : weights_) {
    weight = std::exp(-2.0 * spectra.grid.sigma * spectra.duration() * j++ / count);
    sum += weight;
  }
  for (double& weight : weights_) weight *= count / sum;
}

void BinCorrelation::multiply(std::span<Complex> bins) const {
  const RealFft fft(weights_.size());
  std::vector<Complex> spectrum(fft.bins());
  std::vector<double> samples(weights_.size());
  const auto band = spectrum.begin() + static_cast<std::ptrdiff_t>(first_);
  std::ranges::copy(bins, band);
  // Real, with all of its variance in one part; the inverse transform takes the others twice.
  if (first_ == 0) spectrum[0] *= 2.0;
  fft.inverse(spectrum, samples);
  std::ranges::transform(samples, weights_, samples.begin(), std::multiplies<>());
  fft.forward(samples, spectrum);
  std::copy_n(band, bins.size(), bins.begin());
}

Complex numerator_of(SensorKind kind, const ModalPole& pole, Complex constant, Complex s) {
  const int p = power_of_s(kind);
  const Complex own = p == 0 ? 1.0 : p == 1 ? s : s * s;
  const Complex turned = p == 0 ? s / pole.omega : -pole.omega / s;
  return own * (constant.real() + constant.imag() * turned);
}

std::vector<double> smoothed(std::span<const double> values, double spacing_hz, double reach) {
  const auto half = static_cast<std::size_t>(std::max(1.0, std::round(reach / spacing_hz)));
  std::vector<double> sums(values.size() + 1, 0.0), result(values.size());
  for (std::size_t m = 0; m < values.size(); ++m) sums[m + 1] = sums[m] + values[m];
  for (std::size_t m = 0; m < values.size(); ++m) {
    const std::size_t first = m > half ? m - half : 0;
    const std::size_t last = std::min(values.size(), m + half + 1);
    result[m] = (sums[last] - sums[first]) / static_cast<double>(last - first);
  }
  return result;
}

}  // namespace modcal
