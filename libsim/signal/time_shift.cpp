#include "libsim/signal/time_shift.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {
namespace {

// Below this share of a period the shift is rounding of the given numbers.
constexpr double kNegligible = 1e-9;

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

std::vector<double> advanced(std::span<const double> samples, double delay, double sample_rate) {
  const double duration = static_cast<double>(samples.size()) / sample_rate;
  MODCAL_REQUIRE(std::abs(delay) < duration,
                 "a delay of {:g} s does not fit a record of {:g} s; it must be shorter", delay,
                 duration);
  const double periods = delay * sample_rate;
  const double whole = std::round(periods);
  std::vector<double> result = shifted_by_index(samples, static_cast<std::ptrdiff_t>(whole));
  if (std::abs(periods - whole) <= kNegligible) return result;
  return shifted_by_phase(result, periods - whole);
}

}  // namespace modcal
