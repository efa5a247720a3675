#include "libcalib/likelihood/records/noise_level.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/refusal.hpp"

namespace modcal::noise_level_test {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// The paper's stroke at 25.6 kHz: its 50 modes reach to 0.38 of the sample rate.
BowedCase slow_case() {
  BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  for (std::size_t r = 0; r < 2; ++r) {
    std::vector<double> half;
    for (std::size_t j = 0; j < bowed.clean[r].size(); j += 2) half.push_back(bowed.clean[r][j]);
    remove_mean(half);
    bowed.spread[r] = standard_deviation(half);
    bowed.clean[r] = std::move(half);
  }
  return bowed;
}

NoisyRecords slow_records(const BowedCase& bowed, double level) {
  NoisyRecords records = noisy(bowed, level, 5);
  records.sample_rate = 25600.0;
  return records;
}

TEST(NoiseBand, IsThatOfThePaperWhereTheModesLeaveIt) {
  for (const double top : {500.0, 9800.0, 1.02 * 9800.0}) {
    const NoiseBand band = NoiseBand::above(top, 51200.0, 51200);
    EXPECT_EQ(band.low, 0.293);
    EXPECT_EQ(band.high, 0.488);
    EXPECT_TRUE(band.clear);
  }
  const NoiseBand narrow = NoiseBand::above(9800.0, 25600.0, 25600);
  EXPECT_DOUBLE_EQ(narrow.low, 1.1 * 9800.0 / 25600.0);
  EXPECT_EQ(narrow.high, 0.488);
  EXPECT_FALSE(narrow.clear);
}

TEST(NoiseBand, RefusesARecordWithoutRoomAboveTheModes) {
  EXPECT_THAT(refusal_of([] { NoiseBand::above(9800.0, 22050.0, 22050); }),
              testing::AllOf(testing::HasSubstr("22050 Hz with modes up to 9800 Hz"),
                             testing::HasSubstr("State noise_rms_1 and noise_rms_2")));
  // 1711 bins in 1 s; 171 in 0.1 s.
  EXPECT_EQ(refusal_of([] { NoiseBand::above(9800.0, 25600.0, 25600); }), "accepted");
  EXPECT_THAT(refusal_of([] { NoiseBand::above(9800.0, 25600.0, 2560); }),
              testing::HasSubstr("200 bins"));
  const ModalBasis basis = make_modal_basis(paper_scene().string);
  EXPECT_EQ(refusal_of([&] {
              require_noise_known({1e-3, 1e-3}, basis, 22050.0, 22050);
            }),
            "accepted");
  EXPECT_NE(refusal_of([&] {
              require_noise_known({1e-3, kUnknown}, basis, 22050.0, 22050);
            }),
            "accepted");
}

TEST(NoiseDeviation, IsReadBetweenTheLinesWhereTheModesReachIntoTheUsualBand) {
  const BowedCase bowed = slow_case();
  const NoiseBand band = NoiseBand::above(bowed.truth.basis, 25600.0, 25600);
  for (const double level : {0.01, 0.1}) {
    const NoisyRecords records = slow_records(bowed, level);
    for (std::size_t r = 0; r < 2; ++r) {
      // 1711 bins under a Hann window: 1.28 ½ √(1.94 / 1711) = 2.2 %, five of them; the lines
      // leave 0.1 % of the variance at 1 % noise.
      EXPECT_NEAR(noise_deviation(records.reactions[r], band) / records.deviation[r], 1.0, 0.12);
      EXPECT_GT(noise_deviation(records.reactions[r], {}), 1.2 * records.deviation[r]);
    }
  }
}

TEST(NoisePowerError, IsTheScatterOverDraws) {
  const ModalBasis basis = make_modal_basis(paper_scene().string);
  for (const double rate : {51200.0, 25600.0}) {
    const std::size_t count = 6400;
    const NoiseBand band = NoiseBand::above(basis, rate, count);
    double square = 0.0;
    std::vector<double> noise(count);
    constexpr int kDraws = 200;
    for (int draw = 0; draw < kDraws; ++draw) {
      fill_standard_normal(StreamKey(7).with(static_cast<std::uint64_t>(draw)), noise);
      square += std::pow(std::pow(noise_deviation(noise, band), 2) - 1.0, 2);
    }
    const CalibrationData data = CalibrationData::of_records(noise, noise, rate);
    // Of one end √2 times that of both; the rms of 200 draws scatters by 5 %, four of them.
    const double expected = std::sqrt(2.0) * noise_power_error({kUnknown, kUnknown}, basis, data);
    EXPECT_NEAR(std::sqrt(square / kDraws) / expected, 1.0, 0.2) << rate;
    EXPECT_EQ(noise_power_error({1.0, 1.0}, basis, data), 0.0);
  }
}

TEST(NoiseDeviation, LeavesChi2AtOneWhereTheUsualBandHoldsModes) {
  const BowedCase bowed = slow_case();
  const NoisyRecords records = slow_records(bowed, 0.01);
  ModelPoint start = bowed.truth;
  for (double& omega : start.basis.omega) omega *= 1.004;
  const ContinuationResult result = calibrate_by_continuation(
      start,
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate),
      {.frequencies = false});
  EXPECT_TRUE(result.right) << result.chi2;
  EXPECT_NEAR(result.chi2, 1.0, 4.0 * result.chi2_deviation);
  // The estimated levels' own error, 3.4 % of the power, is most of it.
  EXPECT_LT(result.chi2_deviation, 0.05);
  EXPECT_LT(std::abs(result.law.fundamental - 196.0), 6.0 * result.law.deviation[0]);
}

}  // namespace
}  // namespace modcal::noise_level_test
