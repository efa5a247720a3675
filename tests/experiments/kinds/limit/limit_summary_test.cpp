#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments/kinds/limit/limit.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal::limit_summary_test {
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

LimitOutcome found(bool fits, bool priors_hold, double fundamental) {
  return {.law = {fundamental, 0.0, 0.03, 1.0},
          .law_deviation = {1e-3, 1e-8, 1e-6, 1e-2},
          .frequencies = {fundamental, 2.0 * fundamental},
          .deviations = {1e-5, 1e-5},
          .contact = 0.03,
          .contact_deviation = 1e-6,
          .fits = fits,
          .priors_hold = priors_hold};
}

TEST(SummarizeLevel, TellsWhatChi2ContradictsFromWhatPriorsDo) {
  constexpr double kF0 = 196.0;
  const ModalBasis basis{.length = 0.33,
                         .tension = 51.9,
                         .omega = {2.0 * std::numbers::pi * kF0, 4.0 * std::numbers::pi * kF0},
                         .zeta = {1e-3, 1e-3},
                         .mass = {5e-4, 5e-4}};
  ExpectedLimit bound;
  bound.parameters = {{.parameter = "f0"}};
  bound.law = {1e-3, 1e-8, 1e-6, 1e-2};
  bound.modes = {{.frequency = kF0, .deviation = 1e-5},
                 {.frequency = 2.0 * kF0, .deviation = 1e-5}};
  // One Hz is a thousand bounds.
  const LimitLevel level{.noise_level = 0.01,
                         .outcomes = {found(true, true, kF0), found(true, true, kF0 + 1.0),
                                      found(true, false, kF0), found(true, false, kF0 + 1.0),
                                      found(false, true, kF0 + 1.0), found(false, false, kF0)}};
  const LimitSummary summary = summarize_level(level, {.point = {basis, 0.03}}, bound);
  EXPECT_EQ(summary.runs, 6u);
  EXPECT_EQ(summary.contradicted, 2u);
  EXPECT_EQ(summary.priors_contradicted, 3u);
  EXPECT_EQ(summary.wrong, 3u);
  EXPECT_EQ(summary.silent, 1u);
}

TEST(OutcomeOfALimit, KeepsWhatContradictsIt) {
  for (const bool fits : {false, true}) {
    for (const bool priors_hold : {false, true}) {
      LimitOutcome outcome = found(fits, priors_hold, 196.0);
      const LimitOutcome read = read_outcome<LimitOutcome>(report::json_line(outcome));
      EXPECT_EQ(read.fits, fits);
      EXPECT_EQ(read.priors_hold, priors_hold);
    }
  }
}

TEST(OutcomeOfALimit, KeepsTheDeviationOfChi2) {
  LimitOutcome outcome;
  outcome.chi2 = 1.01;
  outcome.chi2_deviation = 0.0083;
  const LimitOutcome read = read_outcome<LimitOutcome>(report::json_line(outcome));
  EXPECT_EQ(read.chi2, 1.01);
  EXPECT_EQ(read.chi2_deviation, 0.0083);
}

}  // namespace
}  // namespace modcal::limit_summary_test
