// Which mode of a free decay has which number of a string.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace modcal::pluck_numbers_test
