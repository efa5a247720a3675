// Noise levels and contours that the joint inversion takes from a record.
#include "libinverse/joint/sensor_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal::sensor_noise_test {
namespace {

TEST(SensorNoise, IsMeasuredFromTheRecordAlone) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, {}, {});
  for (const double level : {0.01, 0.1}) {
    DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(10)));
    SensorNoiseLevel truth;
    add_noise(string, level, StreamKey(11), &truth);
    SensorNoise::Workspace workspace;
    const auto estimate = sensors.estimate(string.pair(), workspace);
    EXPECT_TRUE(estimate.measured);
    // 4 segments of about 1000 bins: a standard deviation of 1.5 % in the rms, and leakage.
    for (std::size_t r = 0; r < 2; ++r) EXPECT_NEAR(estimate.rms[r] / truth.rms[r], 1.0, 0.06);
  }
  // Without noise the band holds the tail of the response alone, and the cross relation knows it.
  const DrivenString clean = drive(basis, kPosition, jumping_force(samples, StreamKey(10)));
  SensorNoise::Workspace workspace;
  EXPECT_LT(sensors.estimate(clean.pair(), workspace).noise_share, 1e-2);
}

// Noise v of the right sensor alone: the cross relation leaves Σ a v of Σ (1 − a) P_1 + a P_2, a
// the share |H_1|²/(|H_1|² + |H_2|²) of the bin, each bin having the same say, also where H_1 has a
// zero.
TEST(SensorNoise, OfOneSensorIsToldByTheDirectionsOfAllBinsAlike) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  for (const double contact : {0.0237, 0.0348, 0.0422, 0.0681}) {
    DrivenString string = drive(basis, contact, jumping_force(samples, StreamKey(10)));
    const double deviation = 1e-3 * standard_deviation(string.reaction[1]);
    const std::vector<double> noise = normal_draw(samples, StreamKey(4));
    for (std::size_t j = 0; j < samples; ++j) string.reaction[1][j] += deviation * noise[j];
    SensorNoise::Workspace workspace;
    const SensorNoiseLevel level =
        SensorNoise(basis, contact, samples, kRate, {}, {}).estimate(string.pair(), workspace);
    const FrequencyGrid grid = FrequencyGrid::of_record(4096, kRate);
    const StringTransfer transfer = string_transfer(basis, contact, grid, {}, {});
    double along = 0.0, across = 0.0;
    for (std::size_t k = 0; k < grid.bins; ++k) {
      if (grid.omega(k) < 1.2 * basis.omega.back() || grid.omega(k) > 0.97 * M_PI * kRate) continue;
      const double left = std::norm(transfer.reaction[0][k]);
      const double right = std::norm(transfer.reaction[1][k]);
      along += left / (left + right);
      across += right / (left + right);
    }
    const double powers[] = {level.rms[0] * level.rms[0] / level.noise_share,
                             level.rms[1] * level.rms[1] / level.noise_share};
    const double expected =
        along * deviation * deviation / (across * powers[0] + along * powers[1]);
    // The variance of noise is told by some 4000 bins, 1.6 % of it; two of them.
    EXPECT_NEAR(level.noise_share / expected, 1.0, 0.032) << contact;
  }
}

// At twice the frequency of the highest mode no band is left above it.
TEST(SensorNoise, IsSupposedToBeAPercentWhereNoBandShowsIt) {
  const std::size_t samples = 4096;
  const SensorNoise sensors(violin_g(), kPosition, samples, 2.05 * 50.0 * 196.0, {}, {});
  ReactionPair pair;
  const std::vector<double> left = normal_draw(samples, StreamKey(3));
  pair[0] = left;
  SensorNoise::Workspace workspace;
  const SensorNoiseLevel level = sensors.estimate(pair, workspace);
  EXPECT_FALSE(level.measured);
  EXPECT_DOUBLE_EQ(level.rms[0], 0.01 * standard_deviation(left));
  EXPECT_EQ(level.rms[1], 0.0);
}

// A ramp of the period of 196 Hz at 51.2 kHz, which the far sensor sees for 107 samples before a
// wave arrives from 0.1 L, the near one for 11.
TEST(StartsAtRest, WhereTheReactionsAreStillBeforeAWaveArrives) {
  const ModalBasis basis = violin_g();
  const std::array<double, 2> arrivals = first_arrivals(basis, 0.033, {});
  const std::size_t samples = 4096;
  const auto told = [&](double before, double noise, bool far) {
    std::vector<double> reaction = normal_draw(samples, StreamKey(3));
    const auto quiet = static_cast<std::size_t>(arrivals[far ? 1 : 0] * kRate);
    for (std::size_t j = 0; j < samples; ++j) {
      const double turn = static_cast<double>(j) * 196.0 / kRate;
      reaction[j] *= noise;
      reaction[j] += (j < quiet ? before : 1.0) * (turn - std::floor(turn) - 0.5);
    }
    ReactionPair pair;
    pair[far ? 1 : 0] = reaction;
    return record_start(pair, {noise, noise}, arrivals, 196.0, kRate);
  };
  for (const bool far : {false, true}) {
    EXPECT_EQ(told(0.0, 1e-3, far), RecordStart::kRest) << far;
    EXPECT_EQ(told(1.0, 1e-3, far), RecordStart::kMoving) << far;
  }
  EXPECT_EQ(told(0.0, 0.02, true), RecordStart::kRest);
  // The noise hides what the near one would show.
  EXPECT_EQ(told(0.0, 0.02, false), RecordStart::kUntold);
  EXPECT_EQ(record_start({}, {}, arrivals, 196.0, kRate), RecordStart::kUntold);
}

TEST(ContourOf, LiesBetweenOneAndFourOverTheRecord) {
  const ModalBasis basis = violin_g();
  EXPECT_NEAR(contour_of(basis, 1.0, 1e-12), 4.0, 1e-12);
  EXPECT_NEAR(contour_of(basis, 1.0, 0.5), 1.0, 1e-12);
  const double decay = 1e-3 * 2.0 * std::numbers::pi * 196.0;
  EXPECT_NEAR(contour_of(basis, 1.0, 0.01), 0.5 * (std::log(100.0) - decay), 1e-12);
}

}  // namespace
}  // namespace modcal::sensor_noise_test
