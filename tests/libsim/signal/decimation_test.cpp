#include "libsim/signal/decimation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace modcal::decimation_test {
namespace {

// Largest value of what is left of a cosine of unit amplitude, away from its beginning; `cycles` in
// a sample of the result.
double left_of(double cycles, std::size_t step) {
  std::vector<double> signal(400 * step);
  for (std::size_t j = 0; j < signal.size(); ++j) {
    signal[j] = std::cos(2.0 * std::numbers::pi * cycles * static_cast<double>(j) /
                         static_cast<double>(step));
  }
  const std::vector<double> kept = decimated(signal, step);
  double most = 0.0;
  for (std::size_t j = decimation_reach(); j < kept.size(); ++j) {
    most = std::max(most, std::abs(kept[j]));
  }
  return most;
}

TEST(Decimated, PassesWhatLiesBelowAndNothingThatWouldBeFolded) {
  for (const std::size_t step : {2u, 8u}) {
    // 80 dB are 1e-4 in either band; the samples of a cosine may miss its peak by a degree.
    EXPECT_NEAR(left_of(0.25, step), 1.0, 1e-4);
    EXPECT_NEAR(left_of(0.4, step), 1.0, 2e-4);
    EXPECT_LT(left_of(0.6, step), 2e-4);
    EXPECT_LT(left_of(0.9, step), 2e-4);
  }
}

TEST(Decimated, HasNoDelayAndKeepsALevel) {
  std::vector<double> line(800);
  for (std::size_t j = 0; j < line.size(); ++j) line[j] = 3.0 + 0.01 * static_cast<double>(j);
  const std::vector<double> kept = decimated(line, 4);
  ASSERT_EQ(kept.size(), 200 - decimation_reach());
  // Symmetric, of sum 1: rounding of 105 products.
  for (std::size_t j = decimation_reach(); j < kept.size(); ++j) {
    EXPECT_NEAR(kept[j], line[4 * j], 105 * 1.1e-16 * 11.0);
  }
}

TEST(Decimated, StepOfOneIsTheSignal) {
  const std::vector<double> signal = {1.0, -2.0, 0.5};
  EXPECT_EQ(decimated(signal, 1), signal);
  EXPECT_TRUE(decimated(signal, 2).empty());
}

}  // namespace
}  // namespace modcal::decimation_test
