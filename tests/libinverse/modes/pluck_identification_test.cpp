#include "libinverse/modes/pluck_identification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "libinverse/modes/decay_record.hpp"
#include "libsim/base/error.hpp"
#include "tests/libinverse/modes/pluck_case.hpp"

namespace modcal::pluck_identification_test {
namespace {

// Three degrees of freedom, q'' + D q' + K q = 0, q(0) = 0, q'(0) = (1, 1, 1), velocities every
// 0.01 s for 1 s: a published test case of an ERA implementation, its eigenvalues recomputed.
DecayRecord three_degrees_of_freedom() {
  Eigen::Matrix3d stiffness, damping;
  stiffness << 4185.1498, 576.6947, 3646.8923,  //
      576.6947, 2104.9252, -28.0450,            //
      3646.8923, -28.0450, 3451.5583;
  damping << 4.96765646, 0.97182432, 4.0162425,  //
      0.97182432, 6.71403672, -0.86138453,       //
      4.0162425, -0.86138453, 4.28850828;
  Eigen::Matrix<double, 6, 6> state = Eigen::Matrix<double, 6, 6>::Zero();
  state.topRightCorner<3, 3>().setIdentity();
  state.bottomLeftCorner<3, 3>() = -stiffness;
  state.bottomRightCorner<3, 3>() = -damping;
  const Eigen::EigenSolver<Eigen::Matrix<double, 6, 6>> solver(state);
  Eigen::Matrix<std::complex<double>, 6, 1> start =
      Eigen::Matrix<std::complex<double>, 6, 1>::Zero();
  start.tail<3>().setOnes();
  const Eigen::Matrix<std::complex<double>, 6, 1> parts =
      solver.eigenvectors().fullPivLu().solve(start);
  DecayRecord record{.sample_rate = 100.0, .channels = {{}, {}, {}}};
  for (int m = 0; m <= 100; ++m) {
    const Eigen::Matrix<std::complex<double>, 6, 1> now =
        solver.eigenvectors() *
        (parts.array() * (solver.eigenvalues() * (0.01 * m)).array().exp()).matrix();
    for (int c = 0; c < 3; ++c) {
      record.channels[static_cast<std::size_t>(c)].push_back(now[3 + c].real());
    }
  }
  return record;
}

const std::vector<DecayPole> kThreeModes = {
    {1.33602878, 0.0200}, {7.39083199, 0.0750}, {13.79670554, 0.0500}};

TEST(EigensystemRealization, FindsTheModesOfThreeDegreesOfFreedom) {
  const DecayRecord record = three_degrees_of_freedom();
  // The mean that is taken out is one more pole, at z = 1.
  const EigensystemRealization realization(record, 20, 60);
  const auto poles = realization.poles(7);
  ASSERT_EQ(poles.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    // K and D are printed with 8 digits, the frequencies with 9.
    EXPECT_NEAR(poles[k].frequency, kThreeModes[k].frequency, 2e-7 * kThreeModes[k].frequency);
    EXPECT_NEAR(poles[k].damping_ratio, kThreeModes[k].damping_ratio, 1e-7);
  }
  EXPECT_LT(realization.singular_values()[7], 1e-10 * realization.singular_values()[0]);
}

TEST(DampedSinusoidFit, FindsTheModesOfThreeDegreesOfFreedom) {
  const DecayRecord record = three_degrees_of_freedom();
  std::vector<DecayPole> start = kThreeModes;
  for (DecayPole& pole : start) pole.frequency *= 1.01;
  const auto fit = fit_damped_sinusoids(record, start);
  EXPECT_TRUE(fit.converged);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(fit.modes[k].pole.frequency, kThreeModes[k].frequency,
                2e-7 * kThreeModes[k].frequency);
    EXPECT_NEAR(fit.modes[k].pole.damping_ratio, kThreeModes[k].damping_ratio, 1e-7);
  }
}

TEST(DampedSinusoidFit, FindsAmplitudesAndNoiseOfEachChannel) {
  const std::vector<DecayMode> truth = {
      {.pole = {20.0, 0.01}, .amplitude = {{1.0, 0.5}, {-0.3, 0.2}}},
      {.pole = {31.0, 0.005}, .amplitude = {{0.4, 0.0}, {0.8, -0.8}}}};
  DecayRecord record = decay_of(truth, 2, 500.0, 1000);
  for (double& value : record.channels[1]) value += 0.7;  // a sensor's offset
  add_noise(record, 0.01, 3);
  const auto fit = fit_damped_sinusoids(record, std::vector{truth[0].pole, truth[1].pole});
  ASSERT_TRUE(fit.converged);
  // The deviation of a deviation from 1000 samples is 2 %.
  for (const double noise : fit.noise) EXPECT_NEAR(noise, 0.01, 0.0008);
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t c = 0; c < 2; ++c) {
      // σ √(2/N_eff) with 100 samples to a decay: 0.0014 at most.
      EXPECT_NEAR(std::abs(fit.modes[k].amplitude[c] - truth[k].amplitude[c]), 0.0, 0.006);
    }
  }
}

// Error bars mean what they say: 60 draws of noise, whose scatter is known to 1/√(2·60) = 9 %.
TEST(DampedSinusoidFit, ErrorBarsAreTheScatterOverDraws) {
  const std::vector<DecayMode> truth = {
      {.pole = {20.0, 0.01}, .amplitude = {{1.0, 0.5}, {-0.3, 0.2}}},
      {.pole = {21.5, 0.005}, .amplitude = {{0.4, 0.0}, {0.8, -0.8}}}};
  const DecayRecord clean = decay_of(truth, 2, 200.0, 400);
  constexpr int kDraws = 60;
  for (std::size_t k = 0; k < 2; ++k) {
    double frequency = 0.0, ratio = 0.0, bar_frequency = 0.0, bar_ratio = 0.0, bias = 0.0;
    for (int draw = 0; draw < kDraws; ++draw) {
      DecayRecord record = clean;
      add_noise(record, 0.05, 100 + static_cast<std::uint64_t>(draw));
      const auto fit = fit_damped_sinusoids(record, std::vector{truth[0].pole, truth[1].pole});
      ASSERT_TRUE(fit.converged);
      const DecayMode& mode = fit.modes[k];
      bias += (mode.pole.frequency - truth[k].pole.frequency) / kDraws;
      frequency += std::pow(mode.pole.frequency - truth[k].pole.frequency, 2) / kDraws;
      ratio += std::pow(mode.pole.damping_ratio - truth[k].pole.damping_ratio, 2) / kDraws;
      bar_frequency += mode.deviation.frequency / kDraws;
      bar_ratio += mode.deviation.damping_ratio / kDraws;
    }
    // Three times 9 %.
    EXPECT_NEAR(std::sqrt(frequency) / bar_frequency, 1.0, 0.27);
    EXPECT_NEAR(std::sqrt(ratio) / bar_ratio, 1.0, 0.27);
    EXPECT_LT(std::abs(bias), 4.0 * bar_frequency / std::sqrt(kDraws));
  }
}

TEST(DampedSinusoidFit, SaysWhenTwoPolesCannotBeToldApart) {
  const std::vector<DecayMode> truth = {{.pole = {20.0, 0.01}, .amplitude = {{1.0, 0.0}}}};
  const DecayRecord record = decay_of(truth, 1, 200.0, 400);
  const auto fit = fit_damped_sinusoids(record, std::vector{truth[0].pole, truth[0].pole});
  EXPECT_FALSE(fit.full_rank);
  EXPECT_TRUE(std::isnan(fit.modes[0].deviation.frequency));
}

TEST(DampedSinusoidFit, RefusesWhatCannotBeFitted) {
  const DecayRecord record{.sample_rate = 100.0, .channels = {std::vector<double>(50, 1.0)}};
  EXPECT_THROW(fit_damped_sinusoids(record, {}), InvalidInput);
  EXPECT_THROW(fit_damped_sinusoids(record, std::vector<DecayPole>{{60.0, 0.01}}), InvalidInput);
  EXPECT_THROW(fit_damped_sinusoids(record, std::vector<DecayPole>{{10.0, -0.01}}), InvalidInput);
  EXPECT_THROW(fit_damped_sinusoids(record, std::vector<DecayPole>(20, {10.0, 0.01})),
               InvalidInput);
  EXPECT_THROW(fit_damped_sinusoids({.sample_rate = 100.0, .channels = {{1.0}, {}}},
                                    std::vector<DecayPole>{{10.0, 0.01}}),
               InvalidInput);
}

TEST(DecimatedDecay, LeavesPolesAloneAndScalesAmplitudesByItsGain) {
  const std::vector<DecayMode> truth = {{.pole = {150.0, 1e-3}, .amplitude = {{1.0, 0.5}}}};
  const DecayRecord record = decay_of(truth, 1, 12800.0, 12800);
  const DecimatedDecay decay = decimate(record, 200.0);
  EXPECT_EQ(decay.stride, 24u);
  std::vector<DecayMode> scaled = truth;
  scaled[0].amplitude[0] *= decay.gain(truth[0].pole.exponent());
  const DecayRecord expected =
      decay_of(scaled, 1, decay.record.sample_rate, decay.record.samples());
  for (std::size_t m = 0; m < expected.samples(); ++m) {
    // Sums of a thousand products.
    ASSERT_NEAR(decay.record.channels[0][m], expected.channels[0][m], 1e-12);
  }
  EXPECT_NEAR(std::abs(decay.gain({0.0, 2.0 * std::numbers::pi * 200.0})), 1.0, 2e-4);
  for (const double stopped : {0.5 * decay.record.sample_rate, 700.0, 3000.0}) {
    EXPECT_LT(std::abs(decay.gain({0.0, 2.0 * std::numbers::pi * stopped})), 2e-4);
  }
}

TEST(DecimatedDecay, StatesTheNoiseWithinTheBand) {
  DecayRecord record{.sample_rate = 12800.0, .channels = {std::vector<double>(120000, 0.0)}};
  add_noise(record, 1.0, 5);
  const DecimatedDecay decay = decimate(record, 200.0);
  double power = 0.0;
  for (const double value : decay.record.channels[0]) {
    power += value * value / static_cast<double>(decay.record.samples());
  }
  // White noise of variance 1 has 1/stride of it in the band of the new rate; 5000 samples, not
  // all independent.
  EXPECT_NEAR(power * decay.in_band_variance() * static_cast<double>(decay.stride), 1.0, 0.08);
}

class PluckedString : public testing::TestWithParam<std::string> {};

TEST_P(PluckedString, GivesElevenModes) {
  const auto truth = plucked_modes(50, 196.0, 1.5e-4, 0.13);
  DecayRecord record = decay_of(truth, 2, 51200.0, 51200);
  add_noise(record, 0.01, 1);  // the first mode's amplitude is 0.4
  PluckOptions options;
  options.method = GetParam();
  const auto found = identify_pluck(record, 196.5, options);
  ASSERT_EQ(found.modes.size(), 11u);
  EXPECT_THAT(found.missing, testing::IsEmpty());
  const bool likelihood = GetParam() == "maximum_likelihood";
  EXPECT_EQ(found.full_rank, likelihood);
  for (std::size_t k = 0; k < 11; ++k) {
    const auto& [number, mode] = found.modes[k];
    EXPECT_EQ(number, k + 1);
    const DecayPole& right = truth[k].pole;
    const double off = std::abs(mode.pole.frequency - right.frequency);
    if (!likelihood) {
      EXPECT_LT(off, 1e-3 * right.frequency) << number;
      continue;
    }
    EXPECT_LT(off, 4.0 * mode.deviation.frequency) << number;
    EXPECT_LT(std::abs(mode.pole.damping_ratio - right.damping_ratio),
              4.0 * mode.deviation.damping_ratio)
        << number;
    EXPECT_LT(mode.deviation.frequency, 1e-4 * right.frequency);
    EXPECT_NEAR(std::abs(mode.amplitude[0]) / std::abs(truth[k].amplitude[0]), 1.0, 0.1);
  }
  if (likelihood) {
    // 5600 samples, 4 % of the band in the filter's transition.
    for (const double noise : found.noise) {
      EXPECT_NEAR(noise * std::sqrt(9.0) / 0.01, 1.0, 0.1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, PluckedString, testing::Values("era", "maximum_likelihood"));

// Of the record in the whole: filter, realization, selection and fit.
TEST(PluckIdentification, ErrorBarsAreTheScatterOverDraws) {
  const auto truth = plucked_modes(12, 196.0, 1.5e-4, 0.13);
  const DecayRecord clean = decay_of(truth, 2, 12800.0, 6400);
  PluckOptions options;
  options.highest_frequency = 900.0;
  options.block_rows = 100;
  options.columns = 200;
  options.stabilization.highest_order = 30;
  constexpr int kDraws = 30;
  double sum = 0.0;
  std::size_t count = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    DecayRecord record = clean;
    add_noise(record, 0.01, static_cast<std::uint64_t>(draw));
    const auto found = identify_pluck(record, 196.0, options);
    ASSERT_EQ(found.modes.size(), 4u) << draw;
    for (const auto& [number, mode] : found.modes) {
      const double off = mode.pole.frequency - truth[number - 1].pole.frequency;
      sum += std::pow(off / mode.deviation.frequency, 2);
      ++count;
    }
  }
  // 120 squares of about standard normal numbers: their mean is 1 ± 0.13; three times that.
  EXPECT_NEAR(sum / static_cast<double>(count), 1.0, 0.4);
}

TEST(PluckIdentification, ReportsModesWithANodeAtThePluckAsMissing) {
  const auto truth = plucked_modes(12, 196.0, 1.5e-4, 0.25);
  DecayRecord record = decay_of(truth, 2, 12800.0, 12800);
  add_noise(record, 0.003, 1);
  PluckOptions options;
  options.highest_frequency = 1300.0;
  const auto found = identify_pluck(record, 196.0, options);
  EXPECT_THAT(found.missing, testing::ElementsAre(4u));
  ASSERT_EQ(found.modes.size(), 5u);
  EXPECT_EQ(found.modes[3].number, 5u);
}

TEST(PluckIdentification, SilenceHasNoModesAndWrongInputIsRefused) {
  DecayRecord noise{.sample_rate = 12800.0, .channels = {std::vector<double>(6400, 0.0)}};
  EXPECT_THAT(identify_pluck(noise, 196.0).modes, testing::IsEmpty());
  EXPECT_THROW(identify_pluck(noise, 0.0), InvalidInput);
  EXPECT_THROW(identify_pluck(noise, 196.0, {.highest_frequency = 7000.0}), InvalidInput);
  EXPECT_THROW(identify_pluck(noise, 196.0, {.method = "prony"}), InvalidInput);
  EXPECT_THROW(identify_pluck(noise, 196.0, {.skip = 1.0}), InvalidInput);
}

}  // namespace
}  // namespace modcal::pluck_identification_test
