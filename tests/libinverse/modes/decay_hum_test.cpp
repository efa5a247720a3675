#include "libinverse/modes/decay_hum.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "libinverse/modes/pluck_identification.hpp"
#include "tests/libinverse/modes/pluck_case.hpp"

namespace modcal::decay_hum_test {
namespace {

constexpr double kRate = 12800.0, kNoise = 0.003;
constexpr std::size_t kSamples = 19200;  // 1.5 s

// Harmonics of amplitude level/h, of another phase in every channel.
void add_hum(DecayRecord& record, double mains, double level, std::size_t harmonics) {
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    for (std::size_t h = 1; h <= harmonics; ++h) {
      const double number = static_cast<double>(h);
      const double turn = 2.0 * std::numbers::pi * number * mains / record.sample_rate;
      const double phase = 1.3 * number + static_cast<double>(c);
      for (std::size_t m = 0; m < record.samples(); ++m) {
        record.channels[c][m] += level / number * std::cos(turn * static_cast<double>(m) + phase);
      }
    }
  }
}

DecayRecord pluck_of(const std::vector<DecayMode>& truth, std::uint64_t seed) {
  DecayRecord record = decay_of(truth, 2, kRate, kSamples);
  add_noise(record, kNoise, seed);
  return record;
}

// Mean square of frequencies and damping ratios off the truth, in their deviations.
double mean_square(const PluckIdentification& found, const std::vector<DecayMode>& truth) {
  double sum = 0.0;
  for (const auto& [number, mode] : found.modes) {
    const DecayPole& right = truth[number - 1].pole;
    sum +=
        std::pow((mode.pole.frequency - right.frequency) / mode.deviation.frequency, 2) +
        std::pow((mode.pole.damping_ratio - right.damping_ratio) / mode.deviation.damping_ratio, 2);
  }
  return sum / (2.0 * static_cast<double>(found.modes.size()));
}

const PluckOptions kBand = {.highest_frequency = 1300.0};

TEST(DecayHum, IsFittedBesideTheModes) {
  const double mains = 60.07;
  const auto truth = plucked_modes(12, 196.0, 1.5e-4, 0.13);
  DecayRecord record = pluck_of(truth, 1);
  add_hum(record, mains, 0.03, 8);  // the first mode's amplitude is 0.4
  const auto found = identify_pluck(record, 196.0, kBand);
  ASSERT_GE(found.lines.size(), 8u);
  // σ_F of the first line alone: √6 σ/(π T A √N) = √6/(π 1.5 10 √19200) = 4e-4 Hz.
  EXPECT_NEAR(found.lines[0], mains, 2e-3);
  ASSERT_EQ(found.modes.size(), 6u);
  ASSERT_TRUE(found.full_rank);
  // The mean of twelve squared standard normal numbers is 1 ± .41.
  EXPECT_LT(mean_square(found, truth), 2.3);
}

TEST(DecayHum, IsNotFoundWhereThereIsNone) {
  const auto truth = plucked_modes(12, 196.0, 1.5e-4, 0.13);
  EXPECT_THAT(identify_pluck(pluck_of(truth, 2), 196.0, kBand).lines, testing::IsEmpty());
  const DecayRecord clean = decay_of(truth, 2, kRate, kSamples);
  EXPECT_EQ(identify_pluck(clean, 196.0, kBand).modes.size(), 6u);
  // A string of which every mode lies where a line may.
  const auto low = plucked_modes(20, 50.0, 1e-6, 0.13);
  EXPECT_THAT(identify_pluck(pluck_of(low, 3), 50.0, {.highest_frequency = 800.0}).lines,
              testing::IsEmpty());
}

// The fourth mode, at 796.8 Hz, has a node at the pluck; the sixteenth line stands at 800 Hz.
TEST(DecayHum, ALineIsNoMode) {
  const auto truth = plucked_modes(12, 199.0, 1.5e-4, 0.25);
  DecayRecord record = pluck_of(truth, 4);
  add_hum(record, 50.0, 0.3, 20);
  const auto found = identify_pluck(record, 199.0, kBand);
  EXPECT_THAT(found.missing, testing::ElementsAre(4u));
  EXPECT_LT(mean_square(found, truth), 2.3);
}

// Lines stand .02 Hz from the first mode, .12 Hz from the second, .4 Hz from the third, which lose
// all but exp(−2.7) and less in the record.
TEST(DecayHum, OfAStringInTuneLeavesErrorBarsThatHold) {
  auto truth = plucked_modes(12, 200.0, 1.5e-4, 0.13);
  for (DecayMode& mode : truth) mode.pole.damping_ratio *= 6.0;
  DecayRecord record = pluck_of(truth, 5);
  add_hum(record, 50.0, 0.03, 20);
  const auto found = identify_pluck(record, 200.0, kBand);
  ASSERT_GE(found.modes.size(), 5u);
  EXPECT_LT(mean_square(found, truth), 2.3);
}

TEST(DecayHum, PolesOfLinesAreToldByTheRecordsLength) {
  const std::vector<double> lines = {50.0, 100.0};
  EXPECT_TRUE(is_line({{100.4, 1e-4}}, lines, 2.0));
  EXPECT_FALSE(is_line({{100.6, 1e-4}}, lines, 2.0));
  // exp(-0.75) of the amplitude is left: more is lost than by a line that wanders (0.30), unless
  // noise makes it seem so.
  EXPECT_FALSE(is_line({{100.4, 6e-4}}, lines, 2.0));
  EXPECT_TRUE(is_line({{100.4, 6e-4}, {0.01, 1e-4}}, lines, 2.0));
  EXPECT_FALSE(is_line({{100.4, 2e-3}, {0.1, 1e-3}}, lines, 2.0));
}

// A mode near a line of the mains that loses half of its amplitude, and one that loses hardly any
// and stands where no mains are.
TEST(DecayHum, AModeOfAStructureIsNoLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const DecayPole near : {DecayPole{117.0, 2.5e-3}, DecayPole{59.4, 1e-4}}) {
    DecayRecord record = decay_of({{.pole = near, .amplitude = {1.0, 0.6}},
                                   {.pole = {233.3, 3e-3}, .amplitude = {0.7, -1.0}}},
                                  2, 4000.0, 2000);
    add_noise(record, 0.01, 3);
    const auto found = identify_pluck(
        record, nan, {.lowest_frequency = 40.0, .highest_frequency = 500.0, .skip = 0.0});
    EXPECT_THAT(found.lines, testing::IsEmpty()) << near.frequency;
    ASSERT_EQ(found.modes.size(), 2u) << near.frequency;
    const DecayMode& mode = found.modes[0].mode;
    EXPECT_LT(std::abs(mode.pole.frequency - near.frequency), 4.0 * mode.deviation.frequency);
    EXPECT_LT(std::abs(mode.pole.damping_ratio - near.damping_ratio),
              4.0 * mode.deviation.damping_ratio);
  }
}

}  // namespace
}  // namespace modcal::decay_hum_test
