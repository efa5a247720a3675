// Records of benchmarks/truth, read by sensors that saturate, and good ones.
#include "libinverse/waves/saturation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "benchmarks/truth/truth.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::saturation_test {
namespace {

constexpr double kNoise = 0.01;

// As fit_end_relations() finds it of a start that is off: f₀ by 0.3 %, x_c by 0.5 mm, B by 20 %.
const StatedString kFound{
    .length = 0.33, .fundamental = 294.0 * 1.003, .inharmonicity = 1.32e-4, .contact = 0.0415};

truth::TruthRecord stroke(const truth::TruthMismatch& mismatch = {}) {
  truth::TruthRecord record =
      truth::simulate({.fundamental = 294.0, .inharmonicity = 1.1e-4}, {.position = 0.041},
                      {.duration = 0.3, .mismatch = mismatch, .least_rate = 2e6});
  add_noise(record, kNoise, 3);
  return record;
}

std::vector<double> read(std::vector<double> samples, double drive) {
  if (drive == 0.0) return samples;
  const auto [low, high] = std::ranges::minmax(samples);
  const double peak = std::max(-low, high);
  for (double& x : samples) x = peak / drive * std::tanh(drive * x / peak);
  return samples;
}

std::optional<Saturation> found_of(const truth::TruthRecord& record, double left, double right) {
  const std::vector<double> r1 = read(record.r1, left), r2 = read(record.r2, right);
  return saturation_of({r1, r2, record.rate, {}}, kFound);
}

TEST(Saturation, IsToldWithWhatIsMissing) {
  const truth::TruthRecord record = stroke();
  const std::pair<double, double> drives[] = {{1.0, 1.0}, {2.0, 2.0}, {4.0, 4.0}, {2.0, 0.0}};
  for (const auto& [left, right] : drives) {
    SCOPED_TRACE(left);
    const std::optional<Saturation> found = found_of(record, left, right);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->missing[0], 1.0 - std::tanh(left) / left, 0.09);
    EXPECT_NEAR(found->missing[1], right == 0.0 ? 0.0 : 1.0 - std::tanh(right) / right, 0.09);
    EXPECT_LT(3.0 * found->mended, found->unexplained);
  }
}

TEST(Saturation, IsNotToldOfOtherSensors) {
  for (const truth::TruthMismatch& mismatch :
       {truth::TruthMismatch{},
        {.gain = 2.0, .delay = 2e-6, .corner = 2.0},
        {.body_peak = 0.0125, .polarization = {0.1, 0.03}, .drift = 1e-4},
        {.bridge_mass = 0.05}}) {
    EXPECT_FALSE(found_of(stroke(mismatch), 0.0, 0.0).has_value());
  }
}

TEST(Saturation, OfNoSignalIsNone) {
  const std::vector<double> silent(4096, 0.0);
  EXPECT_FALSE(saturation_of({silent, silent, 51200.0, {}}, kFound).has_value());
}

// Of a click in the middle all bins are alike; no order of them is the right one.
TEST(Saturation, OfAClickIsNone) {
  std::vector<double> click(4096, 0.0);
  click[2048] = 1.0;
  EXPECT_FALSE(saturation_of({click, click, 51200.0, {}}, kFound).has_value());
}

}  // namespace
}  // namespace modcal::saturation_test
