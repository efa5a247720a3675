#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/model/damping.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libinverse/safe_problem.hpp"
#include "tests/refusal.hpp"

namespace modcal::one_sided_inversion_test {
namespace {

constexpr double kRate = 51200.0;
constexpr double kPosition = 0.03;

const NoRegularization kNone{NoRegularization::Options{}};
const WaterLevel kWaterLevel{WaterLevel::Options{}};
const WaterLevelClip kClip{WaterLevelClip::Options{}};
const MinimalProduct kMinimalProduct{MinimalProduct::Options{}};
constexpr InversionOutputs kEverything = {
    .force = true, .displacement = true, .velocity = true, .force_spectrum = true};

ModalBasis violin_g() {
  StringModel string;
  string.length = 0.33;
  string.linear_density = 3.1e-3;
  string.fundamental = 196.0;
  return make_modal_basis(string);
}

double largest_difference(std::span<const double> x, std::span<const double> y) {
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) largest = std::max(largest, std::abs(x[i] - y[i]));
  return x.size() == y.size() ? largest : std::numeric_limits<double>::infinity();
}

class EveryLength : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(OneSidedInversion, EveryLength,
                         testing::Values(1, 2, 3, 4, 5, 64, 97, 100, 101, 1009, 1000));

TEST_P(EveryLength, GivesBackAKnownForce) {
  const SafeProblem safe(GetParam());
  const OneSidedInversion inversion(safe.transfer, safe.receptance, GetParam(), kRate);
  const InversionResult result =
      inversion.invert(safe.response(safe.transfer), {kNone, kMinimalProduct, kEverything});
  // cos of the random phase at K/2 may be small: |Re H| > 0.01 with these draws.
  EXPECT_LT(largest_difference(result.force, safe.force), 1e-10);
  EXPECT_LT(largest_difference(result.displacement, safe.response(safe.receptance)), 1e-10);
  EXPECT_EQ(result.force_spectrum.size(), GetParam() / 2 + 1);
  EXPECT_EQ(result.force_spectrum[0], Complex{});
  EXPECT_EQ(result.bins, GetParam() / 2);
  EXPECT_EQ(result.blind_bins, 0u);
  EXPECT_EQ(result.choice.status, ChoiceStatus::kNoParameter);
}

TEST_P(EveryLength, VelocityIsTheDerivativeOfTheDisplacement) {
  const std::size_t samples = GetParam();
  const SafeProblem safe(samples);
  const OneSidedInversion inversion(safe.transfer, safe.receptance, samples, kRate);
  const InversionResult result =
      inversion.invert(safe.response(safe.transfer), {kNone, kMinimalProduct, kEverything});
  const FrequencyGrid grid = FrequencyGrid::of_record(samples, kRate);
  std::vector<Complex> mobility = safe.receptance;
  for (std::size_t k = 0; k < mobility.size(); ++k) mobility[k] *= Complex{0.0, grid.omega(k)};
  const double scale = std::numbers::pi * kRate;  // the largest ω
  EXPECT_LT(largest_difference(result.velocity, safe.response(mobility)), 1e-10 * scale);
}

TEST_P(EveryLength, TakesEveryRegularizer) {
  const SafeProblem safe(GetParam());
  const OneSidedInversion inversion(safe.transfer, safe.receptance, GetParam(), kRate);
  const std::vector<double> reaction = noise(GetParam(), 3);
  for (const auto& entry : Regularizer::registry()) {
    const auto regularizer = Choice<Regularizer>(entry.name).make();
    const InversionResult result = inversion.invert(reaction, {*regularizer, kMinimalProduct});
    ASSERT_EQ(result.force.size(), GetParam());
    for (const double value : result.force) EXPECT_TRUE(std::isfinite(value));
    EXPECT_NE(result.choice.status, ChoiceStatus::kNotComputed);
  }
}

TEST(OneSidedInversion, GivesBackForceAndMotionOfTheString) {
  // 10 periods of a force with lines at 1.3 … times the modes, where |H| is of order 1.
  const ModalBasis basis = violin_g();
  const std::size_t samples = 5120;
  const FrequencyGrid grid = FrequencyGrid::of_record(samples, kRate);
  const RealFft fft(samples);
  std::vector<Complex> force(fft.bins());
  for (std::size_t k = 7; k < 900; k += 11) {
    force[k] = std::polar(100.0, static_cast<double>(k * k));
  }
  for (const End end : {End::kLeft, End::kRight}) {
    const auto transfer = reaction_transfer(basis, kPosition, end, grid);
    const auto receptance = contact_receptance(basis, kPosition, grid);
    std::vector<Complex> reaction(fft.bins()), displacement(fft.bins()), velocity(fft.bins());
    for (std::size_t k = 0; k < fft.bins(); ++k) {
      reaction[k] = transfer[k] * force[k];
      displacement[k] = receptance[k] * force[k];
      velocity[k] = Complex{0.0, grid.omega(k)} * displacement[k];
    }
    const OneSidedInversion inversion(basis, kPosition, end, samples, kRate);
    const InversionResult result =
        inversion.invert(fft.inverse(reaction), {kNone, kMinimalProduct, kEverything});
    // Lines of amplitude 0.04 N; a rounding of R is divided by |H| > 1e-3.
    EXPECT_LT(largest_difference(result.force, fft.inverse(force)), 1e-10);
    EXPECT_LT(largest_difference(result.displacement, fft.inverse(displacement)), 1e-14);
    EXPECT_LT(largest_difference(result.velocity, fft.inverse(velocity)), 1e-10);
  }
}

TEST(OneSidedInversion, WaterLevelsWorkOnTheBinsBelowThem) {
  // K = 8, |H| = 4, 1, 2 in bins 1 to 3 and Re H = −0.5 at K/2; a unit reaction in each.
  const std::vector<Complex> transfer = {1.0, {0.0, 4.0}, {-1.0, 0.0}, {0.0, -2.0}, {-0.5, 9.0}};
  const OneSidedInversion inversion(transfer, transfer, 8, kRate);
  const RealFft fft(8);
  const std::vector<double> reaction = fft.inverse(std::vector<Complex>{5.0, 1.0, 1.0, 1.0, 1.0});
  const GivenParameter level({.value = 1.5});
  const auto zeroed = inversion.invert(reaction, {kWaterLevel, level, kEverything});
  const auto clipped = inversion.invert(reaction, {kClip, level, kEverything});
  const std::vector<Complex> expected_zeroed = {0.0, {0.0, -0.25}, 0.0, {0.0, 0.5}, 0.0};
  const std::vector<Complex> expected_clipped = {
      0.0, {0.0, -0.25}, -1.0 / 1.5, {0.0, 0.5}, -1.0 / 1.5};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(std::abs(zeroed.force_spectrum[k] - expected_zeroed[k]), 0.0, 1e-15) << k;
    EXPECT_NEAR(std::abs(clipped.force_spectrum[k] - expected_clipped[k]), 0.0, 1e-15) << k;
  }
  EXPECT_NEAR(zeroed.choice.kept_share, 4.0 / 7.0, 1e-15);  // bins 1, 3 of 2, 2, 2, 1
}

TEST(OneSidedInversion, StatesBinsWithoutTransfer) {
  SafeProblem safe(100);
  safe.transfer[7] = 0.0;
  safe.transfer[50] = Complex{0.0, 2.0};  // no real part: sampling hides it
  const OneSidedInversion inversion(safe.transfer, safe.receptance, 100, kRate);
  const InversionResult result =
      inversion.invert(noise(100, 8), {kNone, kMinimalProduct, kEverything});
  EXPECT_EQ(result.blind_bins, 2u);
  EXPECT_EQ(result.force_spectrum[7], Complex{});
  EXPECT_EQ(result.force_spectrum[50], Complex{});
  for (const double value : result.force) EXPECT_TRUE(std::isfinite(value));
}

TEST(OneSidedInversion, AContactAtTheSupportIsSeenByNothing) {
  const OneSidedInversion inversion(violin_g(), 0.0, End::kLeft, 64, kRate);
  const InversionResult result = inversion.invert(noise(64, 8), {kWaterLevel, kMinimalProduct});
  EXPECT_EQ(result.blind_bins, 32u);
  EXPECT_EQ(result.choice.status, ChoiceStatus::kNoParameter);
  EXPECT_EQ(norm(result.force), 0.0);
}

TEST(OneSidedInversion, ScalesWithTheData) {
  const std::size_t samples = 1000;
  const OneSidedInversion inversion(violin_g(), kPosition, End::kLeft, samples, kRate);
  const std::vector<double> reaction = noise(samples, 9);
  for (const auto& entry : Regularizer::registry()) {
    const auto regularizer = Choice<Regularizer>(entry.name).make();
    const InversionMethod method{*regularizer, kMinimalProduct, kEverything};
    const InversionResult reference = inversion.invert(reaction, method);
    for (const double factor : {std::ldexp(1.0, 40), std::ldexp(1.0, -40), 1e12, 1e-12}) {
      std::vector<double> scaled = reaction;
      for (double& value : scaled) value *= factor;
      const InversionResult result = inversion.invert(scaled, method);
      EXPECT_EQ(result.choice.parameter(), reference.choice.parameter());
      // Powers of two change no digit; other factors round each sample, and the inversion
      // amplifies by the reach of |H|, about 1e5 here.
      int exponent = 0;
      const bool exact = std::frexp(factor, &exponent) == 0.5;
      for (std::size_t j = 0; j < samples; ++j) {
        const double expected = factor * reference.force[j];
        if (exact) {
          EXPECT_EQ(result.force[j], expected);
          EXPECT_EQ(result.velocity[j], factor * reference.velocity[j]);
        } else {
          EXPECT_NEAR(result.force[j], expected, 1e-10 * factor * norm(reference.force));
        }
      }
    }
  }
}

TEST(OneSidedInversion, DoesNotSeeTheMean) {
  const SafeProblem safe(100);
  const OneSidedInversion inversion(safe.transfer, safe.receptance, 100, kRate);
  std::vector<double> reaction = noise(100, 4);
  const InversionResult reference = inversion.invert(reaction, {kNone, kMinimalProduct});
  for (double& value : reaction) value += 3.0;
  const InversionResult result = inversion.invert(reaction, {kNone, kMinimalProduct});
  EXPECT_LT(largest_difference(result.force, reference.force), 1e-12);
  EXPECT_NEAR(mean(result.force), 0.0, 1e-15);
}

TEST(OneSidedInversion, ComputesOnlyWhatIsAskedFor) {
  const SafeProblem safe(64);
  const OneSidedInversion inversion(safe.transfer, safe.receptance, 64, kRate);
  const InversionOutputs only_velocity = {.force = false, .velocity = true};
  const InversionResult result =
      inversion.invert(safe.force, {kWaterLevel, kMinimalProduct, only_velocity});
  EXPECT_TRUE(result.force.empty());
  EXPECT_TRUE(result.displacement.empty());
  EXPECT_TRUE(result.force_spectrum.empty());
  EXPECT_EQ(result.velocity.size(), 64u);
}

TEST(OneSidedInversion, GivesTheSameBitsFromSeveralThreadsAndWorkspaces) {
  const OneSidedInversion inversion(violin_g(), kPosition, End::kRight, 2048, kRate);
  const InversionMethod method{kWaterLevel, kMinimalProduct, kEverything};
  std::vector<InversionResult> results(8);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      InversionWorkspace workspace;
      InversionResult kept;
      for (std::size_t i = t; i < 8; i += 4) {
        inversion.invert(noise(2048, i), method, workspace, kept);
        results[i] = kept;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < 8; ++i) {
    const InversionResult expected = inversion.invert(noise(2048, i), method);
    EXPECT_EQ(results[i].force, expected.force);
    EXPECT_EQ(results[i].velocity, expected.velocity);
    EXPECT_EQ(results[i].choice.parameter(), expected.choice.parameter());
  }
}

TEST(OneSidedInversion, RefusesWhatItCannotInvert) {
  using testing::HasSubstr;
  const SafeProblem safe(64);
  const OneSidedInversion inversion(safe.transfer, safe.receptance, 64, kRate);
  const InversionMethod method{kWaterLevel, kMinimalProduct};
  std::vector<double> reaction = noise(64, 1);
  reaction[17] = std::nan("");
  EXPECT_THAT(refusal_of([&] { inversion.invert(reaction, method); }), HasSubstr("sample 17"));
  reaction[17] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of([&] { inversion.invert(reaction, method); }), HasSubstr("sample 17"));
  reaction[17] = 1e200;
  EXPECT_THAT(refusal_of([&] { inversion.invert(reaction, method); }), HasSubstr("overflows"));
  EXPECT_THAT(refusal_of([&] { inversion.invert(noise(63, 1), method); }), HasSubstr("63"));
  EXPECT_THROW(OneSidedInversion(violin_g(), 0.4, End::kLeft, 64, kRate), InvalidInput);
  EXPECT_THROW(OneSidedInversion(violin_g(), 0.1, End::kLeft, 0, kRate), InvalidInput);
  EXPECT_THROW(OneSidedInversion(violin_g(), 0.1, End::kLeft, 64, -1.0), InvalidInput);
  EXPECT_THROW(OneSidedInversion(safe.transfer, safe.receptance, 66, kRate), InvalidInput);
  std::vector<Complex> broken = safe.transfer;
  broken[5] = std::nan("");
  EXPECT_THAT(refusal_of([&] { OneSidedInversion(broken, safe.receptance, 64, kRate); }),
              HasSubstr("bin 5"));
}

}  // namespace
}  // namespace modcal::one_sided_inversion_test
