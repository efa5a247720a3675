#include "libinverse/modes/decay_record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/modes/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Windowed-sinc low-pass between two edges given as fractions of the sample rate.
std::vector<double> low_pass(double pass, double stop) {
  constexpr double pi = std::numbers::pi;
  const double width = 2.0 * pi * (stop - pass);
  const auto half = static_cast<std::ptrdiff_t>(
      std::ceil((kDecimatorAttenuation - 7.95) / (2.285 * width) / 2.0));
  const double beta = 0.1102 * (kDecimatorAttenuation - 8.7);
  const double cutoff = pass + stop;  // twice the middle of the transition
  std::vector<double> taps;
  double sum = 0.0;
  for (std::ptrdiff_t j = -half; j <= half; ++j) {
    const double position = static_cast<double>(j) / static_cast<double>(half);
    const double window = std::cyl_bessel_i(0.0, beta * std::sqrt(1.0 - position * position)) /
                          std::cyl_bessel_i(0.0, beta);
    const double x = pi * cutoff * static_cast<double>(j);
    taps.push_back(window * (j == 0 ? 1.0 : std::sin(x) / x));
    sum += taps.back();
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

std::vector<double> filtered(const std::vector<double>& channel, const std::vector<double>& taps,
                             std::size_t stride) {
  std::vector<double> result;
  for (std::size_t first = 0; first + taps.size() <= channel.size(); first += stride) {
    double sum = 0.0;
    for (std::size_t j = 0; j < taps.size(); ++j) sum += taps[j] * channel[first + j];
    result.push_back(sum);
  }
  return result;
}

}  // namespace

void DecayRecord::require_valid() const {
  MODCAL_REQUIRE(sample_rate > 0.0 && std::isfinite(sample_rate),
                 "sample rate {:g} Hz of a decay must be > 0", sample_rate);
  MODCAL_REQUIRE(samples() > 0, "a decay without samples: give at least one channel");
  for (const auto& channel : channels) {
    MODCAL_REQUIRE(channel.size() == samples(),
                   "channels of a decay must have one length: {} and {} samples are given",
                   samples(), channel.size());
    MODCAL_REQUIRE(std::all_of(channel.begin(), channel.end(),
                               [](double value) { return std::isfinite(value); }),
                   "a sample of the decay is not a finite number");
  }
}

double DecayMode::power() const {
  double sum = 0.0;
  for (const std::complex<double>& of_channel : amplitude) sum += std::norm(of_channel);
  return sum;
}

double rounding_level(double noise_rms, double step) {
  if (!(step > 0.0)) return 1.0;
  const double steps = noise_rms / step;
  // A record too short to tell its noise (NaN) is taken to have none.
  const double covered = steps * steps > 1.0 / 12.0 ? steps * steps - 1.0 / 12.0 : 0.0;
  return 1.0 + kRoundingExcess * std::exp(-2.0 * std::numbers::pi * std::numbers::pi * covered);
}

DecayPole DecayPole::of_exponent(std::complex<double> exponent) {
  const double omega = std::abs(exponent);
  return {omega / (2.0 * std::numbers::pi), omega > 0.0 ? -exponent.real() / omega : 0.0};
}

std::complex<double> DecayPole::exponent() const {
  const double omega = 2.0 * std::numbers::pi * frequency;
  return {-damping_ratio * omega, omega * std::sqrt(1.0 - damping_ratio * damping_ratio)};
}

std::complex<double> DecimatedDecay::gain(std::complex<double> exponent) const {
  std::complex<double> sum = 0.0;
  for (std::size_t j = 0; j < taps.size(); ++j) {
    sum += taps[j] * std::exp(exponent * static_cast<double>(j) / original_rate);
  }
  return sum;
}

double DecimatedDecay::in_band_variance() const {
  double power = 0.0;
  for (const double tap : taps) power += tap * tap;
  return 1.0 / (power * static_cast<double>(stride));
}

Decimation decimation_of(std::size_t samples, double rate, double highest) {
  MODCAL_REQUIRE(highest > 0.0 && highest < 0.5 * rate,
                 "a band up to {:g} Hz does not fit into a record of {:g} Hz: take less than half "
                 "of it",
                 highest, rate);
  const auto stride = static_cast<std::size_t>(rate / (2.6 * highest));
  if (stride <= 1) return {1, {1.0}, samples, rate};
  const double new_rate = rate / static_cast<double>(stride);
  std::vector<double> taps = low_pass(1.02 * highest / rate, 0.5 * new_rate / rate);
  MODCAL_REQUIRE(samples >= 2 * taps.size(),
                 "a record of {} samples is too short for a band up to {:g} Hz: its filter has {} "
                 "taps; take a longer record or a wider band",
                 samples, highest, taps.size());
  const std::size_t kept = (samples - taps.size()) / stride + 1;
  return {stride, std::move(taps), kept, new_rate};
}

DecimatedDecay decimate(const DecayRecord& record, double highest) {
  record.require_valid();
  const double rate = record.sample_rate;
  Decimation how = decimation_of(record.samples(), rate, highest);
  if (how.stride <= 1) return {record, 1, {1.0}, rate};
  DecimatedDecay result{{.sample_rate = how.rate}, how.stride, std::move(how.taps), rate};
  for (const auto& channel : record.channels) {
    result.record.channels.push_back(filtered(channel, result.taps, how.stride));
  }
  result.record.rounding = record.rounding;
  return result;
}

}  // namespace modcal
