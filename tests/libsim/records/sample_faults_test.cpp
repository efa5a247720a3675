#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "libsim/records/levels.hpp"

namespace modcal::sample_faults_test {
namespace {

using testing::HasSubstr;

constexpr std::size_t kSize = 20000;

// A sawtooth that is bowed, with 1 % of noise: its peaks are sharp and unlike.
std::vector<double> sawtooth(double noise = 0.01) {
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  std::vector<double> samples;
  for (std::size_t j = 0; j < kSize; ++j) {
    const double turn = std::fmod(static_cast<double>(j) / 174.3, 1.0);
    samples.push_back(2.0 * turn - 1.0 + noise * normal(engine));
  }
  return samples;
}

std::vector<double> sine(double noise) {
  std::vector<double> samples = sawtooth(noise), ideal = sawtooth(0.0);
  for (std::size_t j = 0; j < kSize; ++j) {
    samples[j] += std::sin(M_PI * ideal[j]) - ideal[j];
  }
  return samples;
}

std::vector<double> rounded(std::vector<double> samples, int bits) {
  double peak = 0.0;
  for (const double x : samples) peak = std::max(peak, std::abs(x));
  const double step = 2.0 * peak / std::exp2(bits);
  for (double& x : samples) x = step * std::round(x / step);
  return samples;
}

std::vector<double> clipped(std::vector<double> samples, double limit) {
  for (double& x : samples) x = std::clamp(x, -limit, limit);
  return samples;
}

std::vector<double> held(std::vector<double> samples, std::size_t first, std::size_t count) {
  for (std::size_t j = 0; j < count; ++j) samples[first + j] = samples[first - 1];
  return samples;
}

std::string fault_of(const std::vector<double>& samples) {
  const auto fault = find_fault(samples);
  return fault ? fault->text : "none";
}

TEST(SampleFaults, AreNotInGoodRecords) {
  EXPECT_EQ(fault_of(sawtooth()), "none");
  EXPECT_EQ(fault_of(sine(0.0)), "none");
  for (const int bits : {4, 6, 8, 12, 16, 24}) {
    SCOPED_TRACE(bits);
    EXPECT_EQ(fault_of(rounded(sawtooth(), bits)), "none");
    EXPECT_EQ(fault_of(rounded(sine(0.0), bits)), "none");
    EXPECT_EQ(fault_of(rounded(sine(0.01), bits)), "none");
  }
  EXPECT_EQ(fault_of({1.0, 2.0, 3.0, 5.0}), "none");
  EXPECT_EQ(fault_of({}), "none");
}

TEST(SampleFaults, ASilentChannelIsConstant) {
  EXPECT_THAT(fault_of(std::vector<double>(50, 0.0)), HasSubstr("all 50 samples are 0"));
  EXPECT_THAT(fault_of(std::vector<double>(50, 0.3)), HasSubstr("all 50 samples are 0.3"));
  EXPECT_EQ(fault_of({0.3}), "none");
}

TEST(SampleFaults, AreMagnitudesWithoutASquare) {
  std::vector<double> samples = sawtooth();
  samples[7000] = 1e300;
  EXPECT_THAT(fault_of(samples), HasSubstr("1e+300 is the largest magnitude"));
  EXPECT_EQ(find_fault(samples)->first, 7000u);
  samples = sawtooth();
  for (double& x : samples) x *= 1e-300;
  EXPECT_THAT(fault_of(samples), HasSubstr("state the unit"));
}

TEST(SampleFaults, ASpikeStandsAlone) {
  std::vector<double> samples = sawtooth();
  samples[7000] = -10.0;
  EXPECT_THAT(fault_of(samples), HasSubstr("-10 stands alone"));
  EXPECT_EQ(find_fault(samples)->first, 7000u);
  samples[6999] = -5.0;  // filtered
  EXPECT_THAT(fault_of(samples), HasSubstr("-10 stands alone"));
  samples = sawtooth();
  samples[7000] = -2.0;  // an attack may be twice as loud
  EXPECT_EQ(fault_of(samples), "none");
}

// Three samples of a hammer's blow in an accelerometer.
TEST(SampleFaults, AShortBlowIsNoSpike) {
  std::vector<double> samples = sawtooth();
  samples[6999] = 3.3, samples[7000] = 6.1, samples[7001] = 3.9;
  EXPECT_EQ(fault_of(samples), "none");
  samples[7001] = 2.5;
  EXPECT_THAT(fault_of(samples), HasSubstr("6.1 stands alone"));
}

TEST(SampleFaults, PeaksThatAreClippedPileUp) {
  for (const int bits : {8, 16, 52}) {
    SCOPED_TRACE(bits);
    for (const double limit : {0.5, 0.8, 0.95}) {
      EXPECT_THAT(fault_of(clipped(rounded(sawtooth(), bits), limit)), HasSubstr("are clipped"));
      EXPECT_THAT(fault_of(clipped(rounded(sine(0.01), bits), limit)), HasSubstr("are clipped"));
    }
  }
  std::vector<double> one_side = sawtooth();
  for (double& x : one_side) x = std::max(x, -0.8);
  EXPECT_THAT(fault_of(one_side), HasSubstr("are -0.8, the smallest"));
  EXPECT_EQ(one_side[find_fault(one_side)->first], -0.8);
  // Behind silence at the level of the peaks.
  one_side = sawtooth(0.0);
  for (std::size_t j = 0; j < 500; ++j) one_side[j] = -1.0;
  EXPECT_EQ(fault_of(one_side), "none");
}

TEST(SampleFaults, AGapIsARunThatChanceDoesNotLeave) {
  EXPECT_THAT(fault_of(held(sawtooth(), 7000, 50)), HasSubstr("51 samples in a row"));
  EXPECT_EQ(find_fault(held(sawtooth(), 7000, 50))->first, 6999u);
  EXPECT_THAT(fault_of(held(sawtooth(), 7000, 5)), HasSubstr("6 samples in a row"));
  EXPECT_THAT(fault_of(held(rounded(sawtooth(), 8), 7000, 50)), HasSubstr("samples in a row"));
  EXPECT_EQ(fault_of(held(rounded(sawtooth(), 8), 7000, 3)), "none");
}

TEST(SampleFaults, SilenceIsNoGap) {
  // Before and behind, of equal samples or at the resolution.
  std::vector<double> samples = sawtooth();
  for (double& x : samples) x = std::round(127.0 * x);
  for (std::size_t j = 0; j < 3000; ++j) {
    samples[j] = samples[kSize - 1 - j] = j % 400 == 399 ? 1.0 : 0.0;
  }
  EXPECT_EQ(fault_of(samples), "none");
  // A string that rings out.
  samples = sine(0.002);
  for (std::size_t j = 0; j < kSize; ++j) samples[j] *= std::exp(-static_cast<double>(j) / 2000.0);
  EXPECT_EQ(fault_of(rounded(samples, 8)), "none");
}

TEST(SampleFaults, AChannelIsCutOffBeforeTheEnd) {
  for (const double level : {0.0, 0.3, -2.0}) {
    for (const std::size_t first : {kSize / 5, kSize - 40}) {
      std::vector<double> samples = sawtooth();
      std::fill(samples.begin() + static_cast<std::ptrdiff_t>(first), samples.end(), level);
      EXPECT_THAT(fault_of(samples), HasSubstr("to the end")) << level;
      EXPECT_EQ(find_fault(samples)->first, first);
      EXPECT_THAT(fault_of(rounded(samples, 8)), HasSubstr("record.stop")) << level;
    }
  }
  // Held at its last value, and repeated by chance.
  EXPECT_THAT(fault_of(held(sawtooth(), kSize - 40, 40)), HasSubstr("all 41 samples"));
  EXPECT_EQ(fault_of(held(sawtooth(), kSize - 2, 2)), "none");
}

TEST(SampleFaults, ABeginningOfEqualSamplesIsARest) {
  std::vector<double> samples = sawtooth();
  std::fill_n(samples.begin(), kSize / 5, 0.3);
  EXPECT_EQ(fault_of(samples), "none");
}

}  // namespace
}  // namespace modcal::sample_faults_test
