#include "libinverse/structure/function_contour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {
namespace {

// Measured lines from 0 on, times four: below the first one as s^p, above the last one its value,
// which fades out far from the band.
std::vector<Complex> continued(const std::vector<Complex>& values, SensorKind kind) {
  std::vector<Complex> lines = values;
  const double first = first_line_of(values);
  const auto hole = std::find_if(
      values.begin() + static_cast<std::ptrdiff_t>(first), values.end(),
      [](const Complex& value) { return !std::isfinite(value.real() + value.imag()); });
  MODCAL_REQUIRE(hole == values.end() && first < static_cast<double>(values.size()),
                 "line {} of a response function is not finite: all are needed from the first on",
                 hole - values.begin());
  const Complex least = values[static_cast<std::size_t>(first)];
  for (std::size_t l = 0; static_cast<double>(l) < first; ++l) {
    lines[l] = least * std::pow(static_cast<double>(l) / first, power_of_s(kind));
  }
  const std::size_t count = values.size();
  for (std::size_t l = count; l < 4 * count; ++l) {
    const double far = static_cast<double>(l - count) / static_cast<double>(3 * count);
    const double fading = std::cos(0.5 * std::numbers::pi * far);
    lines.push_back(fading * fading * values.back());
  }
  return lines;
}

Complex interpolated(const std::vector<Complex>& spectrum, double place) {
  const int first = static_cast<int>(std::floor(place)) - kPoints / 2 + 1;
  Complex sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    double weight = 1.0;
    for (int j = 0; j < kPoints; ++j) {
      if (j != i) weight *= (place - (first + j)) / (i - j);
    }
    const auto line = static_cast<std::size_t>(std::abs(first + i));
    sum += weight * (first + i < 0 ? std::conj(spectrum[line]) : spectrum[line]);
  }
  return sum;
}

}  // namespace

double first_line_of(const std::vector<Complex>& values) {
  const auto first =
      std::ranges::find_if(values, [](const Complex& value) { return !std::isnan(value.real()); });
  return static_cast<double>(first - values.begin());
}

std::vector<double> impulse_response(const std::vector<Complex>& values, SensorKind kind) {
  std::vector<Complex> lines = continued(values, kind);
  lines.push_back(0.0);
  const RealFft fft(2 * (lines.size() - 1));
  return fft.inverse(std::move(lines));
}

FunctionContour::FunctionContour(const FrequencyGrid& grid, const ContourSpectra& spectra)
    : grid_(grid), spectra_(spectra), decay_(spectra.grid.sigma - grid.sigma) {
  MODCAL_REQUIRE(decay_ >= -1e-9 * grid.sigma,
                 "the response functions were weighted by an exponential window, and are known on "
                 "contours of {:g} 1/s and more, not of {:g}: state contour or a shorter window",
                 grid.sigma, spectra.grid.sigma);
}

double FunctionContour::duration() const { return 2.0 * std::numbers::pi / grid_.spacing; }

std::vector<Complex> FunctionContour::of(const std::vector<Complex>& values,
                                         SensorKind kind) const {
  const std::vector<double> response = impulse_response(values, kind);
  const std::size_t count = response.size(), before = count / 8, fine = kFine * count;
  const double step = duration() / static_cast<double>(count);
  // About its middle, so that the phase turns as little as it can from bin to bin.
  const auto middle = static_cast<std::ptrdiff_t>(count * 3 / 8);
  std::vector<double> centered(fine, 0.0);
  for (std::size_t j = 0; j < count; ++j) {
    const bool early = j >= count - before;
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(j) - (early ? std::ssize(response) : 0);
    const auto place =
        static_cast<std::size_t>(at - middle + static_cast<std::ptrdiff_t>(fine)) % fine;
    centered[place] = response[j] * std::exp(-decay_ * step * std::abs(static_cast<double>(at)));
  }
  const std::vector<Complex> spectrum = RealFft(fine).forward(centered);
  std::vector<Complex> result;
  const double lag = step * static_cast<double>(middle);
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    const double omega = spectra_.s(m).imag();
    result.push_back(interpolated(spectrum, static_cast<double>(kFine) * omega / grid_.spacing) *
                     std::polar(1.0, -omega * lag));
  }
  return result;
}

double FunctionContour::kernel_power(double omega) const {
  const auto side = [this](double turn, double part) {
    const Complex rate(decay_ * duration(), turn * duration());
    return std::abs(rate) < 1e-6 ? Complex(part) : (1.0 - std::exp(-rate * part)) / rate;
  };
  return std::norm(side(omega, 7.0 / 8.0) + side(-omega, 1.0 / 8.0));
}

std::vector<double> FunctionContour::variance_of(const std::vector<double>& of_lines) const {
  std::vector<double> result;
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    double& variance = result.emplace_back(0.0);
    for (std::size_t l = 0; l < of_lines.size(); ++l) {
      if (of_lines[l] == 0.0) continue;
      const double omega = spectra_.s(m).imag(), line = grid_.omega(l);
      variance += of_lines[l] * (kernel_power(omega - line) + kernel_power(omega + line));
    }
  }
  return result;
}

}  // namespace modcal
