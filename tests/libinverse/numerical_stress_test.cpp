// One-sided inversion where numbers are at their worst, and what it must not depend on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"
#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal::numerical_stress_test {
namespace {

constexpr InversionOutputs kEverything = {
    .force = true, .displacement = true, .velocity = true, .force_spectrum = true};
const NoRegularization kNone{NoRegularization::Options{}};
const Tikhonov kTikhonov{Tikhonov::Options{}};

GivenParameter fixed_at(double level) {
  return GivenParameter({.value = level, .curve = {.points = 0}});
}

double largest(std::span<const double> values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::abs(value));
  return result;
}

double largest_difference(std::span<const double> x, std::span<const double> y) {
  double result = 0.0;
  for (std::size_t j = 0; j < x.size(); ++j) result = std::max(result, std::abs(x[j] - y[j]));
  return result;
}

struct Names {
  std::string regularizer, choice;
};

std::vector<Names> every_pair() {
  std::vector<Names> pairs;
  for (const auto& regularizer : Regularizer::registry()) {
    for (const auto& choice : ParameterChoice::registry()) {
      if (choice.name == "fixed") continue;  // has no default
      pairs.push_back({std::string(regularizer.name), std::string(choice.name)});
    }
  }
  return pairs;
}

class EveryPair : public testing::TestWithParam<Names> {};
INSTANTIATE_TEST_SUITE_P(Registry, EveryPair, testing::ValuesIn(every_pair()),
                         [](const testing::TestParamInfo<Names>& parameter) {
                           return parameter.param.regularizer + "_with_" + parameter.param.choice;
                         });

InversionResult invert(const OneSidedInversion& inversion, std::span<const double> reaction,
                       const Names& names, double noise_rms) {
  const auto regularizer = Choice<Regularizer>(names.regularizer).make();
  const auto choice = Choice<ParameterChoice>(names.choice).make();
  return inversion.invert(reaction, {*regularizer, *choice, kEverything, noise_rms});
}

TEST_P(EveryPair, TakesEveryLengthAndSignal) {
  const ModalBasis basis = violin_g();
  for (const std::size_t samples : {1, 2, 3, 4, 7, 64, 97, 101}) {
    const OneSidedInversion inversion(basis, kPosition, End::kLeft, samples, kRate);
    for (const auto& signal :
         {std::vector<double>(samples, 0.0), std::vector<double>(samples, -3.0),
          normal_draw(samples, StreamKey(1))}) {
      const InversionResult result = invert(inversion, signal, GetParam(), 0.1);
      ASSERT_EQ(result.force.size(), samples);
      for (const auto* values : {&result.force, &result.displacement, &result.velocity}) {
        for (const double value : *values) ASSERT_TRUE(std::isfinite(value)) << samples;
      }
      EXPECT_NE(result.choice.status, ChoiceStatus::kNotComputed);
      EXPECT_FALSE(std::isnan(result.choice.kept_share));
    }
  }
}

TEST_P(EveryPair, ScalesWithTheData) {
  const std::size_t samples = 600;
  const OneSidedInversion inversion(violin_g(), kPosition, End::kRight, samples, kRate);
  const std::vector<double> reaction = normal_draw(samples, StreamKey(9));
  const InversionResult reference = invert(inversion, reaction, GetParam(), 0.1);
  for (const double factor : {std::ldexp(1.0, 40), std::ldexp(1.0, -40), 1e12, 1e-12}) {
    std::vector<double> scaled = reaction;
    for (double& value : scaled) value *= factor;
    const InversionResult result = invert(inversion, scaled, GetParam(), 0.1 * factor);
    EXPECT_EQ(result.choice.parameter(), reference.choice.parameter());
    int exponent = 0;
    const bool exact = std::frexp(factor, &exponent) == 0.5;
    for (std::size_t j = 0; j < samples; ++j) {
      if (exact) {  // powers of two change no digit
        ASSERT_EQ(result.force[j], factor * reference.force[j]);
      } else {  // each sample is rounded, and the inversion amplifies that by up to 1e5
        ASSERT_NEAR(result.force[j], factor * reference.force[j],
                    1e-10 * factor * largest(reference.force));
      }
    }
  }
}

// Force from the reaction the same transfer function makes of it.
double error_of_the_way_back(const ModalBasis& basis, double contact) {
  const std::size_t samples = 1000;
  const FrequencyGrid grid = FrequencyGrid::of_record(samples, kRate);
  const RealFft fft(samples);
  std::vector<double> force = normal_draw(samples, StreamKey(3));
  std::vector<Complex> spectrum = fft.forward(force);
  spectrum.front() = 0.0;
  spectrum.back() = 0.0;
  force = fft.inverse(spectrum);
  const std::vector<Complex> h = reaction_transfer(basis, contact, End::kLeft, grid);
  for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] *= h[k];
  const OneSidedInversion inversion(basis, contact, End::kLeft, samples, kRate);
  const InversionResult result =
      inversion.invert(fft.inverse(spectrum), {kNone, fixed_at(0.0), kEverything});
  return largest_difference(result.force, force);
}

TEST(NumericalStress, DampingThatVanishes) {
  // Rounding of R over the smallest |H| of all bins, about 1e-3 of the largest at ζ = 1e-3; with
  // ζ → 0 peaks grow between the bins, not on them.
  for (const double zeta : {1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
    EXPECT_LT(error_of_the_way_back(violin_g(zeta), kPosition), 1e-9) << zeta;
  }
}

TEST(NumericalStress, AnUndampedModeOnABinIsRefused) {
  ModalBasis basis = violin_g(0.0);
  basis.omega[5] = FrequencyGrid::of_record(1000, kRate).omega(24);
  try {
    error_of_the_way_back(basis, kPosition);
    FAIL() << "accepted";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("bin 24"));
  }
}

// Without damping H is real and passes through zero between two modes; the rate puts bin 24 there.
double rate_with_a_zero_on_bin_24(const ModalBasis& basis, std::size_t samples) {
  const auto response = [&basis](double omega) {
    return reaction_transfer(basis, kPosition, End::kLeft, {.spacing = omega, .bins = 2})[1].real();
  };
  double low = 0.0, high = 0.0;
  for (std::size_t n = 0; n + 1 < basis.size() && high == 0.0; ++n) {
    const double above = basis.omega[n] * (1.0 + 1e-9), below = basis.omega[n + 1] * (1.0 - 1e-9);
    if (response(above) * response(below) < 0.0) {
      low = above;
      high = below;
    }
  }
  EXPECT_GT(high, low);
  const bool rising = response(low) < 0.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    ((response(middle) < 0.0) == rising ? low : high) = middle;
  }
  return low * static_cast<double>(samples) / (2.0 * std::numbers::pi * 24.0);
}

TEST_P(EveryPair, AZeroOfHOnABin) {
  const std::size_t samples = 2000;
  const ModalBasis basis = violin_g(0.0);
  const double rate = rate_with_a_zero_on_bin_24(basis, samples);
  const std::vector<Complex> h =
      reaction_transfer(basis, kPosition, End::kLeft, FrequencyGrid::of_record(samples, rate));
  // The terms of the sum cancel to their rounding.
  ASSERT_LT(std::abs(h[24]), 1e-12 * std::abs(h[20]));
  const OneSidedInversion inversion(basis, kPosition, End::kLeft, samples, rate);
  const InversionResult result =
      invert(inversion, normal_draw(samples, StreamKey(5)), GetParam(), 1.0);
  for (const auto* values : {&result.force, &result.displacement, &result.velocity}) {
    for (const double value : *values) ASSERT_TRUE(std::isfinite(value));
  }
  // Direct inversion has no way to leave the bin out; every regularizer has. R is of the order of
  // √K there: a thousandth of 1/|H| is far below what division would give.
  const bool divides = std::abs(result.force_spectrum[24]) > std::abs(1e-3 * (1.0 / h[24]));
  EXPECT_EQ(divides, GetParam().regularizer == "none");
}

TEST(NumericalStress, CoincidentModes) {
  ModalBasis basis = violin_g();
  basis.omega[3] = basis.omega[2];
  basis.omega[4] = basis.omega[2];
  EXPECT_LT(error_of_the_way_back(basis, kPosition), 1e-9);
}

TEST(Metamorphic, LinearAtAGivenParameter) {
  const std::size_t samples = 777;
  const OneSidedInversion inversion(violin_g(), kPosition, End::kLeft, samples, kRate);
  const auto force_of = [&](std::span<const double> reaction) {
    return inversion.invert(reaction, {kTikhonov, fixed_at(0.05), kEverything}).force;
  };
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  std::vector<double> sum(samples);
  for (std::size_t j = 0; j < samples; ++j) sum[j] = a[j] - 3.0 * b[j];
  const auto of_a = force_of(a), of_b = force_of(b), of_sum = force_of(sum);
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(of_sum[j], of_a[j] - 3.0 * of_b[j], 1e-12 * largest(of_sum));
  }
}

TEST(Metamorphic, FollowsAShiftInTime) {
  const std::size_t samples = 1000, shift = 123;
  const OneSidedInversion inversion(violin_g(), kPosition, End::kLeft, samples, kRate);
  const auto reaction = normal_draw(samples, StreamKey(1));
  std::vector<double> later(samples);
  for (std::size_t j = 0; j < samples; ++j) later[(j + shift) % samples] = reaction[j];
  const Names names{"water_level", "minimal_product"};
  const auto now = invert(inversion, reaction, names, 0.1);
  const auto then = invert(inversion, later, names, 0.1);
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(then.force[(j + shift) % samples], now.force[j], 1e-11 * largest(now.force));
  }
}

TEST(Metamorphic, ForwardOfTheInverseIsTheFilter) {
  const std::size_t samples = 1000;
  const ModalBasis basis = violin_g();
  const OneSidedInversion inversion(basis, kPosition, End::kLeft, samples, kRate);
  const auto h =
      reaction_transfer(basis, kPosition, End::kLeft, FrequencyGrid::of_record(samples, kRate));
  const auto reaction = normal_draw(samples, StreamKey(5));
  const auto measured = RealFft(samples).forward(reaction);
  const double level = 0.05;
  const auto result = inversion.invert(reaction, {kTikhonov, fixed_at(level), kEverything});
  for (std::size_t k = 1; k + 1 < h.size(); ++k) {
    const Complex filtered = std::norm(h[k]) / (std::norm(h[k]) + level * level) * measured[k];
    EXPECT_LT(std::abs(h[k] * result.force_spectrum[k] - filtered),
              1e-12 * (1.0 + std::abs(measured[k])));
  }
}

TEST(Metamorphic, TheLeftEndIsTheRightOneOfTheMirroredString) {
  const std::size_t samples = 1000;
  const ModalBasis basis = violin_g();
  const OneSidedInversion left(basis, kPosition, End::kLeft, samples, kRate);
  const OneSidedInversion right(basis, basis.length - kPosition, End::kRight, samples, kRate);
  const auto reaction = normal_draw(samples, StreamKey(6));
  const InversionMethod method{kTikhonov, fixed_at(0.05), kEverything};
  const auto here = left.invert(reaction, method), there = right.invert(reaction, method);
  // sin(nπ(L − x)/L) rounds to 50 · 1e-16 of its argument.
  EXPECT_LT(largest_difference(here.force, there.force), 1e-10 * largest(here.force));
  EXPECT_LT(largest_difference(here.velocity, there.velocity), 1e-10 * largest(here.velocity));
}

}  // namespace
}  // namespace modcal::numerical_stress_test
