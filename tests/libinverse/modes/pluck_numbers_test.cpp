// Which mode of a free decay has which number of a string.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libinverse/modes/mode_numbers.hpp"
#include "libinverse/modes/pluck_identification.hpp"
#include "tests/libinverse/modes/pluck_case.hpp"

namespace modcal::pluck_numbers_test {
namespace {

// Far up a stiff string modes lie nearer to the next multiples of f0: f_60 is 86.5 f0.
TEST(PluckNumbers, FollowTheLaw) {
  const double fundamental = 30.0;
  const auto truth = plucked_modes(60, fundamental, 3e-4, 0.13);
  ASSERT_GT(truth.back().pole.frequency, 86.0 * fundamental);
  DecayRecord record = decay_of(truth, 2, 8000.0, 8000);
  add_noise(record, 1e-4, 2);
  PluckOptions options;
  options.highest_frequency = 2650.0;
  options.block_rows = 200;
  options.columns = 600;
  options.stabilization.lowest_order = 122;
  options.stabilization.highest_order = 134;
  const auto found = identify_pluck(record, 1.01 * fundamental, options);
  EXPECT_GT(found.modes.size(), 50u);
  EXPECT_EQ(found.modes.back().number, 60u);
  for (const auto& [number, mode] : found.modes) {
    ASSERT_LE(number, 60u);
    const double expected = truth[number - 1].pole.frequency;
    EXPECT_NEAR(mode.pole.frequency, expected, 1e-3 * expected) << number;
  }
}

// A mode of the body at 290 Hz, twice as large as the first, which is the nearest number to it.
TEST(PluckNumbers, AreNoneOfTheBodysHoweverLarge) {
  auto modes = plucked_modes(6, 196.0, 1.5e-4, 0.13);
  const auto truth = modes;
  const std::complex<double> body = 2.0 * std::abs(truth[0].amplitude[0]);
  modes.push_back({.pole = {290.0, 0.05}, .amplitude = {body, body}});
  DecayRecord record = decay_of(modes, 2, 12800.0, 12800);
  add_noise(record, 0.003, 3);
  PluckOptions options;
  options.highest_frequency = 1300.0;
  const auto found = identify_pluck(record, 196.0, options);
  ASSERT_EQ(found.modes.size(), 6u);
  for (const auto& [number, mode] : found.modes) {
    EXPECT_NEAR(mode.pole.frequency, truth[number - 1].pole.frequency, 0.02) << number;
  }
  ASSERT_EQ(found.others.size(), 1u);
  EXPECT_NEAR(found.others[0].pole.frequency, 290.0, 1.0);
}

// Where the string's mode is not there, the body's does not get its number.
TEST(PluckNumbers, AreMissingWhereOnlyTheBodyIs) {
  auto modes = plucked_modes(6, 196.0, 1.5e-4, 0.13);
  modes[0].pole = {290.0, 0.05};
  DecayRecord record = decay_of(modes, 2, 12800.0, 12800);
  add_noise(record, 0.003, 3);
  PluckOptions options;
  options.highest_frequency = 1300.0;
  const auto found = identify_pluck(record, 196.0, options);
  EXPECT_THAT(found.missing, testing::ElementsAre(1u));
  ASSERT_EQ(found.others.size(), 1u);
}

// A second pole of the first mode a third as large and 4e-4 higher; nothing is seen at the second.
TEST(PluckNumbers, DeviationsHoldThatModesMayBeTwoAsOthersAre) {
  const auto mode = [](double frequency, double size) {
    return DecayMode{.pole = {frequency, 1e-3},
                     .deviation = {1e-3, 1e-5},
                     .amplitude = {size, size},
                     .evidence = 1e4 * size * size};
  };
  NumberedModes numbered = {{1, mode(200.0, 3.0)}, {2, mode(400.0, 3.0)}, {3, mode(600.0, 300.0)}};
  std::vector<DecayMode> others = {mode(200.08, 1.0), mode(290.0, 1.0)};
  others[0].pole.damping_ratio = 1.1e-3;
  const auto seconds = seconds_of(others, numbered, 10.0);
  ASSERT_EQ(seconds.size(), 1u);
  EXPECT_EQ(seconds.begin()->first, 1u);
  ASSERT_EQ(others.size(), 1u);
  widen_by_seconds(numbered, seconds, 30.0, 100.0);
  EXPECT_DOUBLE_EQ(numbered.at(1).deviation.frequency, 1e-3);
  // Of the share 1/3 the larger one stands a quarter of the distance from the mean.
  const double shift = std::hypot(4e-4, 1e-4) / 4.0;
  EXPECT_NEAR(numbered.at(2).deviation.frequency, std::hypot(1e-3, 400.0 * shift), 1e-9);
  EXPECT_NEAR(numbered.at(2).deviation.damping_ratio, std::hypot(1e-5, shift), 1e-9);
  // (2d)⁴ 30/E = (Δ² s/(1 + s)²)² of a mode as large as that.
  const double seen = 4.0 / std::sqrt(3.0) * 2e-3 * std::pow(30.0 / 9e8, 0.25);
  ASSERT_LT(seen, 4e-4);
  EXPECT_NEAR(numbered.at(3).deviation.frequency, std::hypot(1e-3, 600.0 * seen / 4.0), 2e-5);
}

// Over a record in which a mode hardly decays t² is all but a constant and a slope by 1/180 of T⁴,
// a fourth of which is of the second moment.
TEST(PluckNumbers, AShortRecordTellsLessOfASecondPole) {
  const DecayMode mode{.pole = {100.0, 1e-6}, .evidence = 1e6};
  const double moment = std::sqrt(720.0 * 30.0 / 1e6);
  EXPECT_NEAR(2.0 * std::numbers::pi * 100.0 * unseen_distance(mode, 1.0, 30.0, 0.5),
              2.0 * std::sqrt(moment) / 0.5, 0.02);
}

DecayMode mode_at(double frequency, double damping_ratio, double size) {
  return {.pole = {frequency, damping_ratio}, .amplitude = {size}};
}

// Decays 1 and 3 d apart: a mode that changes, or two poles. As in three other modes they differ by
// frequency, this one is two as well; where one has a third pole, none is.
TEST(PluckNumbers, ModesChangeUnlessMoreOfThemAreTwo) {
  NumberedModes numbered;
  std::multimap<std::size_t, DecayMode> seconds = {{1, mode_at(100, 3e-3, 0.5)}};
  for (std::size_t n = 1; n <= 4; ++n) {
    numbered.emplace(n, mode_at(100.0 * static_cast<double>(n), 1e-3, 1));
  }
  for (std::size_t n = 2; n <= 4; ++n) {
    EXPECT_THAT(changing_of(numbered, seconds), testing::ElementsAre(1u)) << n;
    seconds.emplace(n, mode_at(101.0 * static_cast<double>(n), 1.2e-3, 0.2));
  }
  EXPECT_THAT(changing_of(numbered, seconds), testing::IsEmpty());
  seconds.emplace(3, mode_at(304, 1e-3, 0.02));
  EXPECT_THAT(changing_of(numbered, seconds), testing::IsEmpty());
  seconds.emplace(3, mode_at(305, 1e-3, 0.05));
  EXPECT_THAT(changing_of(numbered, seconds), testing::ElementsAre(1u, 3u));
  // A second pole below a third tells neither.
  EXPECT_THAT(changing_of(numbered, {{1, mode_at(100, 3e-3, 0.3)}}), testing::IsEmpty());
}

TEST(PluckNumbers, BodiesBesideAModeWidenNothing) {
  NumberedModes numbered;
  for (const std::size_t n : {1u, 2u}) {
    numbered[n] = {.pole = {200.0 * static_cast<double>(n), 1e-3},
                   .deviation = {1e-3, 1e-5},
                   .amplitude = {1.0},
                   .evidence = 1e4};
  }
  const DecayMode body{.pole = {205.0, 0.05}, .deviation = {0.1, 1e-3}, .amplitude = {1.0}};
  widen_by_seconds(numbered, {{1, body}}, 30.0, 100.0);
  EXPECT_DOUBLE_EQ(numbered[2].deviation.frequency, 1e-3);
}

}  // namespace
}  // namespace modcal::pluck_numbers_test
