// Calibrations of records that no part of the libraries has made are right.
#include "tests/libcalib/foreign_record.hpp"

#include <gtest/gtest.h>

namespace modcal::foreign_record_test {
namespace {

TEST(ForeignRecord, IsCalibratedWithinItsDeviations) {
  for (const double noise : {0.01, 0.05}) {
    SCOPED_TRACE(noise);
    expect_right(calibrated(equal_sensors(), {.noise = noise}));
  }
}

TEST(ForeignRecord, WithoutTheModesAboveItIsWrong) {
  const CalibrationResult result =
      calibrated(equal_sensors(), {.support = {.remainder = "none"}, .exact_sensors = true});
  EXPECT_GT(frequency_errors(result).by_data, 2.0 * kFour);
  EXPECT_FALSE(result.continuation->right);
}

// Differences between two answers in the larger of their standard deviations.
double difference(const CalibrationResult& a, const CalibrationResult& b, std::string_view name) {
  const CalibratedParameter &one = parameter(a, name), &other = parameter(b, name);
  return std::abs(one.final - other.final) / std::max(one.deviation, other.deviation);
}
double largest_difference(const CalibrationResult& a, const CalibrationResult& b) {
  double largest = 0.0;
  for (const char* name : {"f0", "B", "x_c", "gain", "delay"}) {
    largest = std::max(largest, difference(a, b, name));
  }
  const std::vector<ModeVerdict>&first = a.continuation->modes, &second = b.continuation->modes;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const ModeVerdict &one = first[i], &other = second[i];
    if (one.source != ModeSource::kIdentified || other.source != ModeSource::kIdentified) continue;
    largest = std::max(largest, std::abs(one.frequency / other.frequency - 1.0) /
                                    std::max(one.deviation, other.deviation));
  }
  return largest;
}

// The same bins, in which 28 modes lie: what is stated above costs time and changes nothing. The
// noise is stated, too: where it is read begins above the modes. (From one ζ for all modes, as
// above, gain and f_1 differ by 0.4.)
TEST(ForeignRecord, TheNumberOfModesIsNoMatter) {
  Settings settings{
      .modes = 30, .highest_frequency = 8500.0, .known_noise = true, .known_damping = true};
  const CalibrationResult few = calibrated(equal_sensors(), settings);
  settings.modes = 50;
  const CalibrationResult many = calibrated(equal_sensors(), settings);
  expect_right(few);
  expect_right(many);
  EXPECT_LT(largest_difference(few, many), 0.3);
  // Where there are none above, it matters.
  settings.modes = 30;
  settings.support.remainder = "none";
  EXPECT_GT(largest_difference(calibrated(equal_sensors(), settings), many), 1.0);
}

TEST(ForeignRecord, SensorsMayDiffer) {
  const truth::TruthRecord record =
      stroke({.gain = 1.005, .delay = 1e-6}, truth::Reactions::kTension);
  const CalibrationResult result = calibrated(record, {});
  expect_right(result);
  EXPECT_LT(std::abs(error(result, "gain", 1.005)), kFour);
  EXPECT_LT(std::abs(error(result, "delay", 1e-6)), kFour);
  // Taken to be equal, no cause is the right one: the frequencies are wrong, and the misfit is
  // plain.
  const CalibrationResult exact = calibrated(record, {.exact_sensors = true});
  EXPECT_GT(frequency_errors(exact).by_data, 2.0 * kFour);
  EXPECT_FALSE(exact.continuation->right);
}

// A resonance of the body in one reaction is a response of its sensor that nobody has stated: one
// with a mode of its own, which moves no frequency.
TEST(ForeignRecord, ABodyMayRingInOneReaction) {
  const truth::TruthRecord record =
      stroke({.body_peak = 0.0125, .body_frequency = 280.0, .body_damping = 0.02},
             truth::Reactions::kTension);
  const CalibrationResult result = calibrated(record, {.noise = 2e-3});
  EXPECT_FALSE(result.continuation->freed.empty());
  expect_right(result);
  const CalibrationResult without = calibrated(record, {.noise = 2e-3, .response = false});
  EXPECT_GT(frequency_errors(without).by_data, 2.0 * kFour);
}

// Damped, such a record is told by what rings at its start, and leads into false minima: two modes
// 1 and 3 % off, "leaving the law", were accepted.
TEST(ForeignRecord, MayBeginInMidStroke) {
  truth::TruthRecord record = truth::simulate(
      {.fundamental = kFundamental, .inharmonicity = kInharmonicity}, {.position = kContact},
      {.duration = 0.8, .reactions = truth::Reactions::kTension});
  const auto before = static_cast<std::ptrdiff_t>(std::lround(0.3 * record.rate));
  for (std::vector<double>* reaction : {&record.r1, &record.r2}) {
    reaction->erase(reaction->begin(), reaction->begin() + before);
  }
  const CalibrationResult result = calibrated(std::move(record), {});
  expect_right(result);
}

TEST(ForeignRecord, HumOfTheMainsIsNoMatter) {
  truth::TruthRecord record = equal_sensors();
  for (std::size_t j = 0; j < record.r1.size(); ++j) {
    const double turn = 2.0 * M_PI * 49.96 * static_cast<double>(j) / record.rate;
    for (int h = 1; h <= 6; ++h) {
      record.r1[j] += 0.02 / h * std::cos(h * turn + h);
      record.r2[j] -= 0.01 / h * std::sin(h * turn);
    }
  }
  const CalibrationResult result = calibrated(record, {});
  expect_right(result);
  ASSERT_GE(result.continuation->lines.size(), 8u);
  // Half a second: a fiftieth of a bin of 2 Hz.
  EXPECT_NEAR(result.continuation->lines.front(), 49.96, 0.04);
  EXPECT_TRUE(calibrated(equal_sensors(), {}).continuation->lines.empty());
}

TEST(ForeignRecord, SupportsMayFeelTheBending) {
  const truth::TruthRecord record = stroke({}, truth::Reactions::kSupport);
  expect_right(calibrated(record, {.support = {.reaction = "support"}}));
}

}  // namespace
}  // namespace modcal::foreign_record_test
