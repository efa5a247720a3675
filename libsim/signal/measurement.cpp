#include "libsim/signal/measurement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"
#include "libsim/signal/tuning.hpp"

namespace modcal {
namespace {

std::vector<double> shifted_by_index(std::span<const double> samples, std::ptrdiff_t shift) {
  const auto last = static_cast<std::ptrdiff_t>(samples.size()) - 1;
  std::vector<double> result(samples.size());
  for (std::ptrdiff_t i = 0; i <= last; ++i) {
    const std::ptrdiff_t source = std::clamp<std::ptrdiff_t>(i + shift, 0, last);
    result[static_cast<std::size_t>(i)] = samples[static_cast<std::size_t>(source)];
  }
  return result;
}

std::vector<double> shifted_by_phase(const std::vector<double>& samples, double periods) {
  std::vector<double> mirrored(samples);
  mirrored.insert(mirrored.end(), samples.rbegin(), samples.rend());
  const RealFft fft(mirrored.size());
  std::vector<Complex> spectrum = fft.forward(mirrored);
  const double turn = 2.0 * std::numbers::pi * periods / static_cast<double>(mirrored.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] *= std::polar(1.0, turn * static_cast<double>(k));
  }
  std::vector<double> result = fft.inverse(std::move(spectrum));
  result.resize(samples.size());
  return result;
}

}  // namespace

void Measurement::visit(OptionVisitor& visitor) {
  visitor("sample_rate", "sampling rate of the recorder",
          {.unit = "Hz", .range = Range::positive()}, sample_rate);
  visitor("noise_level", "noise standard deviation over that of each signal",
          {.range = Range::non_negative()}, noise_level);
  visitor("remove_mean", "remove the mean, as piezoelectric sensors do", remove_mean);
}

Signal measure(const Signal& signal, const Measurement& measurement, const StreamKey& key) {
  MODCAL_REQUIRE(measurement.noise_level >= 0.0, "noise level {:g} must be >= 0",
                 measurement.noise_level);
  MODCAL_REQUIRE(signal.sample_rate == measurement.sample_rate,
                 "the signal is sampled at {:g} Hz, the measurement at {:g} Hz", signal.sample_rate,
                 measurement.sample_rate);
  Signal measured = signal;
  if (measurement.noise_level > 0.0) {
    const double deviation = measurement.noise_level * standard_deviation(signal.samples);
    std::vector<double> noise(signal.size());
    fill_standard_normal(key, noise);
    for (std::size_t i = 0; i < noise.size(); ++i) measured.samples[i] += deviation * noise[i];
  }
  if (measurement.remove_mean) remove_mean(measured.samples);
  return measured;
}

std::vector<double> advanced(std::span<const double> samples, double delay, double sample_rate) {
  const double duration = static_cast<double>(samples.size()) / sample_rate;
  MODCAL_REQUIRE(std::abs(delay) < duration,
                 "a delay of {:g} s does not fit a record of {:g} s; it must be shorter", delay,
                 duration);
  const double periods = delay * sample_rate;
  const double whole = std::round(periods);
  std::vector<double> result = shifted_by_index(samples, static_cast<std::ptrdiff_t>(whole));
  if (std::abs(periods - whole) <= kNegligibleShift) return result;
  return shifted_by_phase(result, periods - whole);
}

}  // namespace modcal
