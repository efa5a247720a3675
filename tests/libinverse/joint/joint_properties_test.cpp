// What a joint inversion keeps: linearity, shifts, mirror, scale, zeros, allocations.
#include <gtest/gtest.h>

#include <numbers>

#include "libsim/base/error.hpp"
#include "tests/allocations.hpp"
#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal::joint_properties_test {
namespace {

TEST(JointInversion, ForwardOfTheInverseIsTheFilter) {
  const std::size_t samples = 1000;
  const ModalBasis basis = violin_g();
  const JointModel model = contour_at(2.0, samples);
  const JointInversion inversion(basis, kPosition, samples, kRate, model);
  FrequencyGrid grid = FrequencyGrid::of_record(samples, kRate);
  grid.sigma = model.sigma;
  const std::vector<Complex> h = reaction_transfer(basis, kPosition, End::kLeft, grid);
  const std::vector<double> reaction = normal_draw(samples, StreamKey(5));
  const std::vector<double> variance(grid.bins, 0.7);
  const SensorNoiseLevel noise{.rms = {0.3, 0.0}};
  JointMethod method = method_with(kJumps, kEverything);
  method.known_variance = variance;
  const auto result = invert(inversion, {reaction, {}}, noise, method);
  std::vector<double> weighted(samples);
  for (std::size_t j = 0; j < samples; ++j) {
    weighted[j] = reaction[j] * std::exp(-model.sigma * static_cast<double>(j) / kRate);
  }
  const std::vector<Complex> measured = RealFft(samples).forward(weighted);
  for (std::size_t k = 1; k + 1 < grid.bins; ++k) {
    const double q = std::norm(h[k]) / (0.3 * 0.3);
    const Complex filtered = q * 0.7 / (1.0 + q * 0.7) * measured[k];
    EXPECT_LT(std::abs(h[k] * result.identified.force_spectrum[k] - filtered),
              1e-12 * (1.0 + std::abs(measured[k])))
        << k;
  }
}

TEST(JointInversion, IsLinearForAGivenPrior) {
  const std::size_t samples = 777;
  const ModalBasis basis = violin_g();
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  const std::vector<double> variance(samples / 2 + 1, 1.0);
  const SensorNoiseLevel noise{.rms = {0.1, 0.2}};
  JointMethod method = method_with(kJumps);
  method.known_variance = variance;
  const auto force_of = [&](std::span<const double> left, std::span<const double> right) {
    return invert(inversion, {left, right}, noise, method).identified.force;
  };
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  const auto c = normal_draw(samples, StreamKey(3)), d = normal_draw(samples, StreamKey(4));
  std::vector<double> left(samples), right(samples);
  for (std::size_t j = 0; j < samples; ++j) {
    left[j] = a[j] - 3.0 * c[j];
    right[j] = b[j] - 3.0 * d[j];
  }
  const auto first = force_of(a, b), second = force_of(c, d), sum = force_of(left, right);
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(sum[j], first[j] - 3.0 * second[j], 1e-11);
  }
}

TEST(JointInversion, FollowsAShiftInTime) {
  // The periodic problem knows no beginning.
  const std::size_t samples = 1000, shift = 123;
  const ModalBasis basis = violin_g();
  const JointInversion inversion(basis, kPosition, samples, kRate,
                                 {.truncation = Truncation::kWrapped});
  const SensorNoiseLevel noise{.rms = {0.1, 0.2}};
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  std::vector<double> later_a(samples), later_b(samples);
  for (std::size_t j = 0; j < samples; ++j) {
    later_a[(j + shift) % samples] = a[j];
    later_b[(j + shift) % samples] = b[j];
  }
  const auto now = invert(inversion, {a, b}, noise, method_with(kLearned)).identified.force;
  const auto later =
      invert(inversion, {later_a, later_b}, noise, method_with(kLearned)).identified.force;
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(later[(j + shift) % samples], now[j], 1e-9 * standard_deviation(now));
  }
}

TEST(JointInversion, DoesNotMindWhichEndIsLeft) {
  // Seen from the other end the string has x_c → L − x_c, and the reactions change places and sign:
  // they pull the other way.
  const std::size_t samples = 1500;
  const ModalBasis basis = violin_g();
  const DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(6)));
  const JointModel model = contour_at(2.0, samples);
  const JointInversion here(basis, kPosition, samples, kRate, model);
  const JointInversion there(basis, basis.length - kPosition, samples, kRate, model);
  const auto seen = invert(here, string.pair(), {.rms = {0.01, 0.02}}, method_with(kLearned));
  const auto mirrored = invert(there, {string.reaction[1], string.reaction[0]},
                               {.rms = {0.02, 0.01}}, method_with(kLearned));
  const double scale = standard_deviation(seen.identified.force);
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(mirrored.identified.force[j], seen.identified.force[j], 1e-8 * scale);
  }
}

TEST(JointInversion, ScalesWithTheData) {
  const std::size_t samples = 1000;
  const ModalBasis basis = violin_g();
  const SensorNoise noise(basis, kPosition, samples, kRate, {}, {});
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  const auto a = normal_draw(samples, StreamKey(7)), b = normal_draw(samples, StreamKey(8));
  const auto force_of = [&](double factor) {
    std::vector<double> left = a, right = b;
    for (double& value : left) value *= factor;
    for (double& value : right) value *= factor;
    SensorNoise::Workspace workspace;
    return invert(inversion, {left, right}, noise.estimate({left, right}, workspace),
                  method_with(kLearned, kEverything))
        .identified.force;
  };
  const auto reference = force_of(1.0);
  for (const double factor : {std::ldexp(1.0, 40), std::ldexp(1.0, -40)}) {
    const auto scaled = force_of(factor);
    for (std::size_t j = 0; j < samples; ++j) EXPECT_EQ(scaled[j], factor * reference[j]);
  }
  const double rms = standard_deviation(reference);
  for (const double factor : {1e12, 1e-12}) {
    const auto scaled = force_of(factor);
    for (std::size_t j = 0; j < samples; ++j) {
      EXPECT_NEAR(scaled[j], factor * reference[j], 1e-9 * factor * rms);
    }
  }
}

class EveryJointLength : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(JointInversion, EveryJointLength,
                         testing::Values(1, 2, 3, 4, 5, 97, 100, 101, 1009));

TEST_P(EveryJointLength, TakesEveryPriorAndTruncationAndSignal) {
  const std::size_t samples = GetParam();
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, {}, {});
  for (const Truncation truncation :
       {Truncation::kShiftedContour, Truncation::kTransient, Truncation::kWrapped}) {
    JointModel model;
    model.truncation = truncation;
    if (truncation == Truncation::kShiftedContour) model = contour_at(2.0, samples);
    const JointInversion inversion(basis, kPosition, samples, kRate, model);
    for (const auto& entry : ForcePrior::registry()) {
      const auto prior = Choice<ForcePrior>(entry.name).make();
      for (const auto& signal :
           {std::vector<double>(samples, 0.0), std::vector<double>(samples, 3.0),
            normal_draw(samples, StreamKey(1))}) {
        SensorNoise::Workspace workspace;
        const auto noise = sensors.estimate({signal, signal}, workspace);
        const auto result =
            invert(inversion, {signal, signal}, noise, method_with(*prior, kEverything));
        ASSERT_EQ(result.identified.force.size(), samples);
        for (const auto* values : {&result.identified.force, &result.identified.displacement,
                                   &result.identified.velocity}) {
          for (const double value : *values) ASSERT_TRUE(std::isfinite(value)) << entry.name;
        }
      }
    }
  }
}

TEST(JointInversion, ZeroInZeroOut) {
  const std::size_t samples = 512;
  const JointInversion inversion(violin_g(), kPosition, samples, kRate, contour_at(2.0, samples));
  const std::vector<double> zero(samples, 0.0);
  const auto result = invert(inversion, {zero, zero}, {}, method_with(kLearned));
  for (const double value : result.identified.force) EXPECT_EQ(value, 0.0);
}

TEST(JointInversion, StandsUndampedCoincidentModesAndContactsAtASupport) {
  const std::size_t samples = 1024;  // bins of 50 Hz: modes moved onto them are poles on a bin
  ModalBasis basis = violin_g(0.0);
  basis.omega[3] = basis.omega[2];
  basis.omega[5] = 2.0 * std::numbers::pi * 50.0 * 24.0;
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  for (const double contact : {kPosition, 0.0, basis.length, 0.5 * basis.length}) {
    const JointInversion inversion(basis, contact, samples, kRate, contour_at(2.0, samples));
    const auto result =
        invert(inversion, {a, b}, {.rms = {0.1, 0.1}}, method_with(kLearned, kEverything));
    for (const double value : result.identified.force) ASSERT_TRUE(std::isfinite(value));
    for (const double value : result.identified.velocity) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(JointInversion, AllocatesNothingAfterTheFirstCall) {
  const std::size_t samples = 2048;
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, {}, {});
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  const auto c = normal_draw(samples, StreamKey(3));
  JointWorkspace workspace;
  JointResult result;
  const JointMethod method = method_with(kLearned, kEverything);
  const auto call = [&](const ReactionPair& pair) {
    inversion.invert(pair, sensors.estimate(pair, workspace.noise), method, workspace, result);
  };
  call({a, b});
  const std::size_t before = allocations();
  call({b, c});
  call({c, a});
  EXPECT_EQ(allocations() - before, 0u);
}
}  // namespace
}  // namespace modcal::joint_properties_test
