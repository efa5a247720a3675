#include "libinverse/waves/wave_reconstruction.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "libinverse/waves/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/model/transfer.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {
namespace {

constexpr int kHalf = kDelayTaps / 2;

void require_pair(const ModalBasis& basis, double contact, double sample_rate,
                  std::span<const double> left, std::span<const double> right) {
  MODCAL_REQUIRE(left.size() == right.size() && !left.empty(),
                 "the reactions have {} and {} samples: waves need both, equally long", left.size(),
                 right.size());
  MODCAL_REQUIRE(contact > 0.0 && contact < basis.length,
                 "contact {:g} m is not inside the string of {:g} m", contact, basis.length);
  MODCAL_REQUIRE(sample_rate > 0.0, "sample rate {:g} Hz must be positive", sample_rate);
  for (const auto samples : {left, right}) {
    for (std::size_t j = 0; j < samples.size(); ++j) {
      MODCAL_REQUIRE(std::isfinite(samples[j]), "sample {} of a reaction is {:g}", j, samples[j]);
    }
  }
}

// x at a real place, by band-limited interpolation; 0 before the record.
double value_at(std::span<const double> x, double place) {
  const auto centre = static_cast<std::ptrdiff_t>(std::floor(place));
  const double norm = std::cyl_bessel_i(0.0, kDelayKaiser);
  double sum = 0.0;
  for (std::ptrdiff_t j = centre - kHalf + 1; j <= centre + kHalf; ++j) {
    if (j < 0 || j >= static_cast<std::ptrdiff_t>(x.size())) continue;
    const double distance = place - static_cast<double>(j);
    const double share = 2.0 * distance / kDelayTaps;
    if (std::abs(share) >= 1.0) continue;
    const double angle = std::numbers::pi * distance;
    const double cardinal = std::abs(angle) < 1e-9 ? 1.0 : std::sin(angle) / angle;
    const double window =
        std::cyl_bessel_i(0.0, kDelayKaiser * std::sqrt(1.0 - share * share)) / norm;
    sum += cardinal * window * x[static_cast<std::size_t>(j)];
  }
  return sum;
}

// x(t + shift) for every sample: one row of weights serves them all, as the fraction is the same.
std::vector<double> shifted(std::span<const double> x, double shift) {
  const double whole = std::floor(shift);
  std::vector<double> impulse(kDelayTaps + 1, 0.0), weight;
  impulse[kHalf] = 1.0;
  for (std::ptrdiff_t tap = -kHalf; tap <= kHalf; ++tap) {
    weight.push_back(value_at(impulse, kHalf + (shift - whole) - static_cast<double>(tap)));
  }
  std::vector<double> result(x.size(), 0.0);
  const auto size = static_cast<std::ptrdiff_t>(x.size());
  for (std::ptrdiff_t k = 0; k < size; ++k) {
    double sum = 0.0;
    for (std::ptrdiff_t tap = -kHalf; tap <= kHalf; ++tap) {
      const std::ptrdiff_t j = k + static_cast<std::ptrdiff_t>(whole) + tap;
      if (j >= 0 && j < size) {
        sum += weight[static_cast<std::size_t>(tap + kHalf)] * x[static_cast<std::size_t>(j)];
      }
    }
    result[static_cast<std::size_t>(k)] = sum;
  }
  return result;
}

// ω and ζ of a continuous mode number: ω/n linear between the modes, constant beyond them.
struct ContinuousMode {
  double pace, pace_slope;  // ω/n and its change with n
  double zeta;
};

ContinuousMode mode_near(const ModalBasis& basis, double number) {
  const auto count = static_cast<double>(basis.size());
  const double n = std::clamp(number, 1.0, count);
  const auto low = static_cast<std::size_t>(std::min(n, std::max(1.0, count - 1.0))) - 1;
  const std::size_t high = std::min(low + 1, basis.size() - 1);
  const double share = n - static_cast<double>(low + 1);
  const double pace_low = basis.omega[low] / static_cast<double>(low + 1);
  const double pace_high = basis.omega[high] / static_cast<double>(high + 1);
  return {pace_low + share * (pace_high - pace_low), pace_high - pace_low,
          basis.zeta[low] + share * (basis.zeta[high] - basis.zeta[low])};
}

struct Propagation {
  Complex wavenumber;  // k [1/m]
  /// Force behind a wave over that on the ideal string, from d(ω² + 2ζωs + s²)/dn at the wave's n.
  Complex impedance_ratio;
};

// Fixed-point iteration on ω(n) = s (−ζ − i√(1 − ζ²)).
Propagation propagation_at(const ModalBasis& basis, Complex s) {
  Complex n = Complex(0.0, -1.0) * s / basis.omega[0];
  for (int i = 0; i < 30; ++i) {
    const ContinuousMode mode = mode_near(basis, n.real());
    const Complex target = s * Complex(-mode.zeta, -std::sqrt(1.0 - mode.zeta * mode.zeta));
    const Complex pace = mode.pace + mode.pace_slope * Complex(0.0, n.imag());
    const Complex next = target / pace;
    const bool done = std::abs(next - n) <= 1e-12 * std::abs(next);
    n = next;
    if (done) break;
  }
  const ContinuousMode mode = mode_near(basis, n.real());
  const double root = std::sqrt(1.0 - mode.zeta * mode.zeta);
  const double ideal = std::pow(std::numbers::pi / basis.length, 2) * basis.tension * basis.length /
                       (2.0 * basis.mass[0]);
  const Complex slope = mode.pace + mode.pace_slope * n;
  return {n * std::numbers::pi / basis.length, slope * Complex(0.0, -root) * s / (n * ideal)};
}

std::vector<Complex> weighted_spectrum(const RealFft& fft, std::span<const double> x) {
  std::vector<double> samples(x.begin(), x.end());
  for (std::size_t j = 0; j < samples.size(); ++j) {
    samples[j] *=
        std::exp(-kContourWeight * static_cast<double>(j) / static_cast<double>(x.size()));
  }
  return fft.forward(samples);
}

std::vector<double> unweighted_signal(const RealFft& fft, std::vector<Complex> spectrum) {
  std::vector<double> samples = fft.inverse(std::move(spectrum));
  for (std::size_t j = 0; j < samples.size(); ++j) {
    samples[j] *=
        std::exp(kContourWeight * static_cast<double>(j) / static_cast<double>(samples.size()));
  }
  return samples;
}

}  // namespace

WaveReconstruction reconstruct_from_waves(const ModalBasis& basis, double contact,
                                          double sample_rate, std::span<const double> left,
                                          std::span<const double> right, OutgoingWave outgoing) {
  require_pair(basis, contact, sample_rate, left, right);
  const double speed = 2.0 * basis.length * basis.frequency(0);
  const bool is_left = outgoing == OutgoingWave::kLeft;
  const std::span<const double> near = is_left ? left : right, far = is_left ? right : left;
  const double near_path = is_left ? contact : basis.length - contact;
  const double near_delay = near_path / speed * sample_rate;
  const double far_delay = (basis.length - near_path) / speed * sample_rate;
  const double ahead = std::ceil(near_delay) + kHalf;
  MODCAL_REQUIRE(static_cast<double>(near.size()) > ahead,
                 "the record of {} samples ends before a wave from the contact has arrived ({:g} "
                 "samples)",
                 near.size(), ahead);
  const std::vector<double> out = shifted(near, near_delay), back = shifted(near, -near_delay),
                            in = shifted(far, -far_delay);
  const double impedance = basis.tension / speed;
  WaveReconstruction result{std::vector<double>(near.size()), std::vector<double>(near.size()),
                            near.size() - static_cast<std::size_t>(ahead)};
  for (std::size_t k = 0; k < result.valid; ++k) {
    result.force[k] = -out[k] - in[k];
    result.velocity[k] = (back[k] - out[k]) / (2.0 * impedance);
  }
  return result;
}

WaveReconstruction reconstruct_with_loss(const ModalBasis& basis, double contact,
                                         double sample_rate, std::span<const double> left,
                                         std::span<const double> right, OutgoingWave outgoing) {
  require_pair(basis, contact, sample_rate, left, right);
  const bool is_left = outgoing == OutgoingWave::kLeft;
  const RealFft fft(left.size());
  const std::vector<Complex> near = weighted_spectrum(fft, is_left ? left : right);
  const std::vector<Complex> far = weighted_spectrum(fft, is_left ? right : left);
  const double near_path = is_left ? contact : basis.length - contact;
  const double far_path = basis.length - near_path;
  FrequencyGrid grid = FrequencyGrid::of_record(left.size(), sample_rate);
  grid.sigma = kContourWeight * sample_rate / static_cast<double>(left.size());
  std::vector<Complex> force(grid.bins), velocity(grid.bins);
  for (std::size_t k = 0; k < grid.bins && grid.omega(k) <= 1.02 * basis.omega.back(); ++k) {
    const Complex s(grid.sigma, grid.omega(k));
    const Propagation wave = propagation_at(basis, s);
    const Complex i_k = Complex(0.0, 1.0) * wave.wavenumber;
    force[k] = -wave.impedance_ratio *
               (near[k] * std::exp(i_k * near_path) + far[k] * std::exp(-i_k * far_path));
    // T y_x = −2 Z v at the end, and Z = T k/ω: v = i ω (e^{-ikx} − e^{ikx}) R/(2 i k T).
    velocity[k] = s / (i_k * basis.tension) * 0.5 * near[k] *
                  (std::exp(-i_k * near_path) - std::exp(i_k * near_path));
  }
  return {unweighted_signal(fft, std::move(force)), unweighted_signal(fft, std::move(velocity)),
          left.size()};
}

}  // namespace modcal
