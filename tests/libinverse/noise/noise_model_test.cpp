#include "libinverse/noise/noise_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/random.hpp"

namespace modcal::noise_model_test {
namespace {

// 400 bins of noise of unit levels; `signal` more in the measure of the last term.
std::vector<NoiseRow> rows_of(std::uint64_t seed, double signal) {
  constexpr std::size_t kRows = 400;
  std::vector<double> uniform(4 * kRows);
  fill_uniform(StreamKey(seed).with("noise model"), uniform);
  std::vector<NoiseRow> rows(kRows);
  for (std::size_t k = 0; k < kRows; ++k) {
    const double* u = &uniform[4 * k];
    NoiseRow& row = rows[k];
    row.octaves = 1.0 - static_cast<double>(k) / kRows;
    row.by = {u[0], 1.0 - u[0], 0.0, u[1]};
    row.power = -std::log(u[2]) * (1.0 + signal * u[1]);
  }
  return rows;
}

// A χ² of two degrees has the variance 4: the mean over 100 records is within 4 √(4/100).
TEST(NoiseModel, ExcessOfNoiseAloneIsAChiSquare) {
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const NoiseModel model(rows_of(seed, 0.0), {.count = 2});
    Eigen::VectorXd factors = model.white();
    model.fit({1, 0}, factors);
    const NoiseModel::Excess excess = model.excess({1, 0}, factors);
    EXPECT_EQ(excess.degrees, 2.0);
    mean += excess.statistic / 100.0;
  }
  EXPECT_NEAR(mean, 2.0, 0.8);
}

TEST(NoiseModel, ExcessKnowsASignal) {
  const NoiseModel model(rows_of(1, 3.0), {.count = 2});
  Eigen::VectorXd factors = model.white();
  model.fit({1, 0}, factors);
  const NoiseModel::Excess excess = model.excess({1, 0}, factors);
  EXPECT_GT(excess.above, 0.0);
  EXPECT_GT(excess.statistic, 20.0);  // noise alone in one of 20 000
}

}  // namespace
}  // namespace modcal::noise_model_test
