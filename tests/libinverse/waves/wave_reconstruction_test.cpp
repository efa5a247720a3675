#include "libinverse/waves/wave_reconstruction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/model/damping.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::wave_reconstruction_test {
namespace {

constexpr double kRate = 51200.0, kContact = 0.03;
constexpr std::size_t kSamples = 32768;

ModalBasis ideal_string(double zeta, double inharmonicity = 0.0) {
  StringModel string;
  string.length = 0.33;
  string.linear_density = 3.1e-3;
  string.fundamental = 196.0;
  string.inharmonicity = inharmonicity;
  string.modes = 120;
  string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{zeta});
  return make_modal_basis(string);
}

// Bursts of 0.3 ms: nothing above 4 kHz, half of the 20 modes below count.
std::vector<double> bursts() {
  std::vector<double> force(kSamples);
  for (std::size_t j = 0; j < kSamples; ++j) {
    const double t = static_cast<double>(j) / kRate;
    for (const double at : {0.01, 0.031, 0.033, 0.075, 0.11}) {
      force[j] += std::exp(-0.5 * std::pow((t - at) / 1.5e-4, 2)) * (at > 0.07 ? -1.0 : 0.6);
    }
  }
  return force;
}

// Response of the string at rest by its transfer functions, on a contour far enough to the right
// that nothing wraps: e^{−12}.
std::vector<double> response(const std::vector<double>& force, const ModalBasis& basis,
                             bool velocity, End end) {
  const double sigma = 12.0 * kRate / static_cast<double>(2 * kSamples);
  FrequencyGrid grid = FrequencyGrid::of_record(2 * kSamples, kRate);
  grid.sigma = sigma;
  std::vector<double> x(2 * kSamples, 0.0);
  for (std::size_t j = 0; j < kSamples; ++j) {
    x[j] = force[j] * std::exp(-sigma * static_cast<double>(j) / kRate);
  }
  const RealFft fft(2 * kSamples);
  std::vector<Complex> spectrum = fft.forward(x);
  const std::vector<Complex> transfer = velocity ? contact_receptance(basis, kContact, grid)
                                                 : reaction_transfer(basis, kContact, end, grid);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] *= transfer[k];
    if (velocity) spectrum[k] *= Complex(sigma, grid.omega(k));
  }
  x = fft.inverse(spectrum);
  x.resize(kSamples);
  for (std::size_t j = 0; j < kSamples; ++j)
    x[j] *= std::exp(sigma * static_cast<double>(j) / kRate);
  return x;
}

double error(const std::vector<double>& x, const std::vector<double>& y, std::size_t first,
             std::size_t last) {
  return relative_rms_error(std::span(x).subspan(first, last - first),
                            std::span(y).subspan(first, last - first));
}

// The modal model leaves out the modes above the 120th, which answer statically: R₁ lacks
// Σ_{n>N} (2/nπ) sin(nπξ) f, at most (2/πN)/(2 sin(πξ/2)) f = 0.0187 f at ξ = 1/11.
constexpr double kRemainder = 0.0187;

TEST(WaveReconstruction, GivesTheForceOnTheIdealString) {
  const ModalBasis basis = ideal_string(0.0);
  const std::vector<double> force = bursts();
  const auto left = response(force, basis, false, End::kLeft);
  const auto right = response(force, basis, false, End::kRight);
  const auto velocity = response(force, basis, true, End::kLeft);
  for (const OutgoingWave wave : {OutgoingWave::kLeft, OutgoingWave::kRight}) {
    const auto w = reconstruct_from_waves(basis, kContact, kRate, left, right, wave);
    ASSERT_GT(w.valid, kSamples - 200);
    EXPECT_LT(error(w.force, force, 0, w.valid), kRemainder);
    EXPECT_LT(error(w.velocity, velocity, 0, w.valid), kRemainder);
  }
}

// Only the wave that arrives at x = 0: f(t) = −R₁(t + τ₁), at 0.44 of the sample rate, where the
// delays still pass what is 0.06 of it under half to 1e-4.
TEST(WaveReconstruction, DelaysPassWhatIsNearHalfTheSampleRate) {
  const ModalBasis basis = ideal_string(0.0);
  const auto reaction = [](double j) {
    const double share = j / 4096.0;
    if (share <= 0.0 || share >= 1.0) return 0.0;
    return std::pow(std::sin(std::numbers::pi * share), 2) *
           std::sin(2.0 * std::numbers::pi * 0.44 * j);
  };
  std::vector<double> left(4096), right(4096, 0.0);
  for (std::size_t j = 0; j < left.size(); ++j) left[j] = reaction(static_cast<double>(j));
  const auto w = reconstruct_from_waves(basis, kContact, kRate, left, right, OutgoingWave::kLeft);
  const double delay = kContact / (2.0 * 0.33 * 196.0) * kRate;
  for (std::size_t j = 100; j < 3900; ++j) {
    EXPECT_NEAR(w.force[j], -reaction(static_cast<double>(j) + delay), 1e-4) << j;
  }
}

// Against the modal inversion: no line of code in common below the Fourier transform. A damped
// string whose record has died out, so that the modal inversion does not wrap.
TEST(WaveReconstruction, AgreesWithTheModalInversion) {
  const ModalBasis basis = ideal_string(0.02);
  std::vector<double> force = bursts();
  const auto left = response(force, basis, false, End::kLeft);
  const auto right = response(force, basis, false, End::kRight);
  const NoRegularization regularizer({});
  const GivenParameter choice({.value = 0.0});
  const InversionResult modal = OneSidedInversion(basis, kContact, End::kRight, kSamples, kRate)
                                    .invert(right, {.regularizer = regularizer, .choice = choice});
  const auto wave = reconstruct_with_loss(basis, kContact, kRate, left, right, OutgoingWave::kLeft);
  // Both stand for the force: what a damping ratio of 2 % changes in the wave's decay is second
  // order, and the model's own damping law (2ζω_n s beside ω_n² + s²) first order, 2ζ.
  EXPECT_LT(error(wave.force, force, 0, kSamples), 0.05);
  EXPECT_LT(error(wave.force, modal.force, 200, kSamples - 200), 0.06);
  EXPECT_GT(correlation(wave.force, modal.force), 0.998);
}

TEST(WaveReconstruction, KnowsLossAndDispersion) {
  const ModalBasis basis = ideal_string(1e-3, 1.4e-4);
  const std::vector<double> force = bursts();
  const auto left = response(force, basis, false, End::kLeft);
  const auto right = response(force, basis, false, End::kRight);
  const auto ideal =
      reconstruct_from_waves(basis, kContact, kRate, left, right, OutgoingWave::kLeft);
  const auto real = reconstruct_with_loss(basis, kContact, kRate, left, right, OutgoingWave::kLeft);
  const double with = error(real.force, force, 0, ideal.valid);
  EXPECT_LT(with, 0.05);
  EXPECT_LT(with, 0.3 * error(ideal.force, force, 0, ideal.valid));
  const auto velocity = response(force, basis, true, End::kLeft);
  EXPECT_LT(error(real.velocity, velocity, 0, ideal.valid), 0.05);
}

TEST(WaveReconstruction, TheMirroredStringGivesTheSame) {
  const ModalBasis basis = ideal_string(1e-3);
  const std::vector<double> force = bursts();
  const auto left = response(force, basis, false, End::kLeft);
  const auto right = response(force, basis, false, End::kRight);
  const auto here =
      reconstruct_from_waves(basis, kContact, kRate, left, right, OutgoingWave::kLeft);
  const auto there = reconstruct_from_waves(basis, basis.length - kContact, kRate, right, left,
                                            OutgoingWave::kRight);
  ASSERT_EQ(here.valid, there.valid);
  // The paths differ by the rounding of L − (L − x_c).
  EXPECT_LT(error(here.force, there.force, 0, here.valid), 1e-9);
}

TEST(WaveReconstruction, RefusesWhatIsNoPair) {
  const ModalBasis basis = ideal_string(0.0);
  std::vector<double> left(500, 0.0), right(499, 0.0);
  EXPECT_THROW(reconstruct_from_waves(basis, kContact, kRate, left, right, OutgoingWave::kLeft),
               InvalidInput);
  right.push_back(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(reconstruct_with_loss(basis, kContact, kRate, left, right, OutgoingWave::kLeft),
               InvalidInput);
  right.back() = 0.0;
  EXPECT_THROW(reconstruct_from_waves(basis, 0.33, kRate, left, right, OutgoingWave::kLeft),
               InvalidInput);
  left.resize(20);
  right.resize(20);
  EXPECT_THROW(reconstruct_from_waves(basis, kContact, kRate, left, right, OutgoingWave::kLeft),
               InvalidInput);
}

}  // namespace
}  // namespace modcal::wave_reconstruction_test
