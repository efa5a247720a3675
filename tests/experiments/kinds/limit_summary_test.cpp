#include "experiments/kinds/limit_summary.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace modcal {
namespace {

LimitSummary level_of(double level, double ratio, double bias, double reported, std::size_t count) {
  LimitSummary summary;
  summary.level = level;
  // In units of a bound that grows with the noise.
  const double bound = 1e-4 * level;
  summary.rows.push_back({.noise_percent = 100.0 * level,
                          .parameter = "B",
                          .rmse = ratio * bound,
                          .bias = bias * bound,
                          .bound = bound,
                          .reported = reported * bound,
                          .count = count,
                          .law = true});
  return summary;
}

TEST(PooledRows, CountErrorsInBounds) {
  const std::vector<PooledRow> rows =
      pooled_rows({level_of(0.0, 7.0, 7.0, 7.0, 100), level_of(0.01, 0.9, 0.1, 1.0, 100),
                   level_of(0.1, 1.2, -0.2, 1.1, 50)});
  ASSERT_EQ(rows.size(), 1u);  // no other parameter has a row
  const PooledRow& row = rows.front();
  EXPECT_EQ(row.parameter, "B");
  EXPECT_EQ(row.count, 150u);  // the level without noise has no bound
  const double square = (100.0 * 0.81 + 50.0 * 1.44) / 150.0;
  EXPECT_NEAR(row.ratio, std::sqrt(square), 1e-12);
  EXPECT_NEAR(row.bias, (10.0 - 10.0) / 150.0, 1e-12);
  EXPECT_NEAR(row.sd_ratio, std::sqrt((100.0 * 1.0 + 50.0 * 1.21) / 150.0 / square), 1e-12);
}

TEST(PooledRows, AreNoneWithoutRuns) {
  EXPECT_TRUE(pooled_rows({}).empty());
  EXPECT_TRUE(pooled_rows({level_of(0.1, 1.0, 0.0, 1.0, 0)}).empty());
}

TEST(OutcomeOfALimit, KeepsTheDeviationOfChi2) {
  LimitOutcome outcome;
  outcome.chi2 = 1.01;
  outcome.chi2_deviation = 0.0083;
  const LimitOutcome read = read_limit_outcome(outcome_text(outcome));
  EXPECT_EQ(read.chi2, 1.01);
  EXPECT_EQ(read.chi2_deviation, 0.0083);
}

}  // namespace
}  // namespace modcal
