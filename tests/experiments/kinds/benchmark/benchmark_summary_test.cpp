#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/kinds/benchmark/benchmark.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::benchmark_summary_test {
namespace {

using ::testing::HasSubstr;

BenchmarkTask task_of(std::size_t method, std::size_t replicate, double error, bool success) {
  BenchmarkTask task{
      .task = 3 * replicate + method, .method = method, .replicate = std::to_string(replicate)};
  task.outcome.frequency_error = error;
  task.outcome.success = success;
  task.outcome.frequency_rms_error = 2.0 * error;
  task.outcome.frequency_bound = 0.5;
  task.outcome.stop = StopReason::kSmallStep;
  task.outcome.evaluations = 100 + static_cast<std::int64_t>(method);
  task.outcome.value = success ? 1.0 : 3.0;
  task.outcome.truth_value = 2.0;
  task.outcome.trace = {{1, 4.0}, {50, task.outcome.value}};
  return task;
}

// Methods whose errors are drawn about 1, `ratio` and 10, the last failing on every third draw.
BenchmarkGrid grid_of(std::size_t draws, double ratio) {
  BenchmarkGrid grid{.methods = {"a", "b", "c"},
                     .objectives = {"peak", "peak", "peak"},
                     .searches = {"a", "b", "c"},
                     .conditions = {"noise 1 %"},
                     .noise_levels = {0.01}};
  std::vector<double> normal(3 * draws);
  fill_standard_normal(StreamKey(7), normal);
  for (std::size_t i = 0; i < draws; ++i) {
    grid.tasks.push_back(task_of(0, i, std::exp(0.3 * normal[3 * i]), true));
    grid.tasks.push_back(task_of(1, i, ratio * std::exp(0.3 * normal[3 * i + 1]), true));
    grid.tasks.push_back(task_of(2, i, 10.0 * std::exp(0.3 * normal[3 * i + 2]), false));
    if (i % 3 == 0) grid.tasks.back().outcome = {.failure = "needs a gradient"};
  }
  return grid;
}

TEST(BenchmarkSummary, RanksMethodsThatDifferAndNoOthers) {
  const std::vector<BenchmarkCell> apart = benchmark_cells(grid_of(20, 2.0));
  ASSERT_EQ(apart.size(), 3u);
  EXPECT_EQ(apart[0].rank, 1u);
  EXPECT_EQ(apart[1].rank, 2u);
  EXPECT_EQ(apart[2].rank, 3u);
  const std::vector<BenchmarkCell> alike = benchmark_cells(grid_of(20, 1.0));
  EXPECT_EQ(alike[0].rank, 1u);
  EXPECT_EQ(alike[1].rank, 1u);
  EXPECT_EQ(alike[2].rank, 3u);
}

TEST(BenchmarkSummary, ClaimsNoRankFromAFewDraws) {
  for (const BenchmarkCell& cell : benchmark_cells(grid_of(4, 100.0))) EXPECT_EQ(cell.rank, 1u);
}

// None is worse than any, however few the draws are.
TEST(BenchmarkSummary, PutsWhatHasNoResultLast) {
  BenchmarkGrid grid = grid_of(3, 1.0);
  for (BenchmarkTask& task : grid.tasks) {
    if (task.method == 0) task.outcome = {.failure = "needs a gradient"};
  }
  const std::vector<BenchmarkCell> cells = benchmark_cells(grid);
  EXPECT_EQ(cells[0].rank, 3u);
  EXPECT_EQ(cells[1].rank, 1u);
  EXPECT_EQ(cells[2].rank, 1u);
}

TEST(BenchmarkSummary, CountsFailuresAndTheirReasons) {
  const BenchmarkCell cell = benchmark_cells(grid_of(20, 1.0))[2];
  EXPECT_EQ(cell.n, 20u);
  EXPECT_EQ(cell.failures, 7u);
  EXPECT_EQ(cell.successes, 0u);
  EXPECT_EQ(cell.reason_count, 13u);
  EXPECT_EQ(cell.reason, "ended in a minimum above the value at the truth");
}

// Wilson's interval in closed form: 0 of n ends at z²/(n + z²), 5 of 10 at ½ ± z/(2√(n + z²)).
TEST(BenchmarkSummary, GivesWilsonsIntervals) {
  const double z = 1.959963984540054;
  const SuccessShare none = success_share(0, 20);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_NEAR(none.high, z * z / (20.0 + z * z), 1e-15);
  const SuccessShare half = success_share(5, 10);
  EXPECT_NEAR(half.high, 0.5 + 0.5 * z / std::sqrt(10.0 + z * z), 1e-15);
  EXPECT_NEAR(half.low, 1.0 - half.high, 1e-15);
  EXPECT_EQ(success_share(0, 0).high, 1.0);
}

TEST(BenchmarkSummary, ConcludesInWords) {
  const BenchmarkGrid grid = grid_of(20, 1.0);
  const std::vector<std::string> sentences = recommendations(grid, benchmark_cells(grid));
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_THAT(sentences[0], HasSubstr("At noise 1 %: use a (median error"));
  EXPECT_THAT(sentences[0],
              HasSubstr("20 of 20 right, 100 evaluations); not to be told apart from it: b"));
  EXPECT_THAT(failing_methods(grid, benchmark_cells(grid)),
              testing::ElementsAre("c fails on 20 of 20 draws at noise 1 %; on 13 it ended in a "
                                   "minimum above the value at the truth."));
}

// The same methods are the best at 1 % and 2 %, nothing is right at 5 %: two sentences, not three.
TEST(BenchmarkSummary, SaysOnceWhatHoldsForNeighbouringConditions) {
  BenchmarkGrid grid = grid_of(20, 1.0);
  grid.conditions = {"noise 1 %", "noise 2 %", "noise 5 %"};
  grid.noise_levels = {0.01, 0.02, 0.05};
  const std::vector<BenchmarkTask> draws = grid.tasks;
  for (const std::size_t condition : {1u, 2u}) {
    for (BenchmarkTask task : draws) {
      task.condition = condition;
      task.outcome.success = task.outcome.success && condition == 1;
      grid.tasks.push_back(std::move(task));
    }
  }
  const std::vector<std::string> sentences = recommendations(grid, benchmark_cells(grid));
  ASSERT_EQ(sentences.size(), 2u);
  EXPECT_THAT(sentences[0], HasSubstr("At noise 1 %, 2 %: use a (median error"));
  EXPECT_THAT(sentences[0], HasSubstr("40 of 40 right, 100 evaluations)"));
  EXPECT_THAT(sentences[1], HasSubstr("At noise 5 %: no method is right"));
}

// Both methods of an objective fail under both conditions: one sentence, with all draws counted.
TEST(BenchmarkSummary, TellsAnObjectiveThatNoOptimizerGetsRightOnce) {
  BenchmarkGrid grid{.methods = {"a, peak", "b, peak", "a, other"},
                     .objectives = {"peak", "peak", "other"},
                     .searches = {"a", "b", "a"},
                     .conditions = {"noise 1 %", "noise 5 %"},
                     .noise_levels = {0.01, 0.05}};
  for (std::size_t condition = 0; condition < 2; ++condition) {
    for (std::size_t i = 0; i < 20; ++i) {
      for (std::size_t method = 0; method < 3; ++method) {
        grid.tasks.push_back(task_of(method, i, 0.1, method == 2));
        grid.tasks.back().condition = condition;
      }
    }
  }
  EXPECT_EQ(recommendations(grid, benchmark_cells(grid)).size(), 1u);
  const std::vector<std::string> sentences = failing_methods(grid, benchmark_cells(grid));
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_EQ(sentences[0],
            "peak with every optimizer fails on 80 of 80 draws at all conditions; it ended in a "
            "minimum above the value at the truth.");
}

// Root of the mean square over draws; the bound of every draw is 0.5.
TEST(BenchmarkSummary, HoldsTheErrorAgainstTheBound) {
  BenchmarkGrid grid = grid_of(20, 1.0);
  double sum = 0.0;
  for (const BenchmarkTask& task : grid.tasks) {
    if (task.method == 0) sum += std::pow(task.outcome.frequency_rms_error, 2) / 20.0;
  }
  const BenchmarkCell cell = benchmark_cells(grid)[0];
  EXPECT_NEAR(cell.rmse, std::sqrt(sum), 1e-12);
  EXPECT_NEAR(cell.bound_ratio, 2.0 * cell.rmse, 1e-12);
  EXPECT_EQ(bound_map(grid, benchmark_cells(grid)).rows.size(), 3u);
  for (BenchmarkTask& task : grid.tasks) task.outcome.frequency_bound = std::nan("");
  EXPECT_TRUE(std::isnan(benchmark_cells(grid)[0].bound_ratio));
  EXPECT_TRUE(bound_map(grid, benchmark_cells(grid)).rows.empty());
}

// The task offered for replay is a draw of that method with the median error.
TEST(BenchmarkSummary, NamesTheDrawInTheMiddle) {
  const BenchmarkGrid grid = grid_of(9, 1.0);
  const BenchmarkCell cell = benchmark_cells(grid)[1];
  ASSERT_EQ(cell.task % 3, 1);
  EXPECT_EQ(grid.tasks[static_cast<std::size_t>(cell.task)].outcome.frequency_error,
            cell.error.median);
}

TEST(BenchmarkSummary, DrawsTheBoundBesideTheErrorsAndOneConditionAtATime) {
  BenchmarkGrid grid = grid_of(10, 1.0);
  grid.conditions.push_back("noise 5 %");
  grid.noise_levels.push_back(0.05);
  const std::size_t first = grid.tasks.size();
  for (std::size_t i = 0; i < first; ++i) {
    grid.tasks.push_back(grid.tasks[i]);
    grid.tasks.back().condition = 1;
    grid.tasks.back().task += first;
  }
  const std::vector<BenchmarkCell> cells = benchmark_cells(grid);
  const report::Figure errors = error_figure(grid, cells);
  report::check_figure(errors);
  ASSERT_EQ(errors.panels[0].series.size(), 4u);
  EXPECT_EQ(errors.panels[0].series[0].label, "Cramér–Rao bound");
  EXPECT_EQ(errors.panels[0].series[0].y, (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(errors.panels[0].series[1].y_low.size(), 2u);
  for (const report::Figure& figure :
       {data_profile(grid), performance_profile(grid), waterfall_figure(grid),
        work_precision_figure(grid, cells), trace_figure(grid)}) {
    report::check_figure(figure);
    std::size_t shown = 0;
    for (const report::Series& series : figure.panels[0].series) {
      EXPECT_EQ(series.tasks.size(), series.x.size()) << figure.id;
      ASSERT_EQ(series.tags.back().facet, "condition") << figure.id;
      shown += series.hidden ? 0 : 1;
    }
    EXPECT_GT(shown, 0u) << figure.id;
    EXPECT_GT(figure.panels[0].series.size(), shown) << figure.id;
  }
}

TEST(BenchmarkSummary, SaysWhyNoMethodIsRight) {
  BenchmarkGrid grid{.methods = {"a"}, .conditions = {"noise 1 %"}, .noise_levels = {0.01}};
  grid.tasks.push_back(task_of(0, 1, 0.1, false));
  grid.tasks.back().outcome = {.failure = "needs a gradient"};
  EXPECT_EQ(recommendations(grid, benchmark_cells(grid)).front(),
            "At noise 1 %: no method is right; on 1 of 1 draws a refused or broke: needs a "
            "gradient.");
}

TEST(BenchmarkSummary, DrawsProfilesThatEndAtTheShareSolved) {
  const BenchmarkGrid grid = grid_of(10, 1.0);
  for (const report::Figure& figure : {data_profile(grid), performance_profile(grid)}) {
    report::check_figure(figure);
    ASSERT_EQ(figure.panels[0].series.size(), 2u);  // the third method solves nothing
    EXPECT_EQ(figure.panels[0].series[0].y.back(), 1.0);
    EXPECT_GT(figure.panels[0].y.range->at(1), 1.0) << "curves at 1 do not run in the border";
    EXPECT_THAT(figure.caption, HasSubstr("10 draws"));
  }
  EXPECT_EQ(performance_profile(grid).panels[0].series[0].x.front(), 1.0);
  EXPECT_NEAR(performance_profile(grid).panels[0].series[1].x.front(), 1.01, 1e-12);
}

TEST(BenchmarkSummary, ShortensLabels) {
  EXPECT_EQ(short_label("{type: nlopt, algorithm: LN_SBPLX}"), "nlopt LN_SBPLX");
  EXPECT_EQ(short_label("grid"), "grid");
  EXPECT_EQ(short_label("5 %"), "5 %");
  EXPECT_EQ(short_label("[1, 2]"), "[1 2]");
  EXPECT_EQ(short_label(""), "");
}

TEST(BenchmarkOutcome, ComesBackBitForBit) {
  BenchmarkOutcome outcome{.stop = StopReason::kTimeBudget, .evaluations = 12};
  outcome.value = 1.0 / 3.0;
  outcome.truth_value = -std::numeric_limits<double>::infinity();
  outcome.trace = {{1, std::nan("")}, {2, 0.1}};
  const std::string text = report::json_line(outcome);
  const BenchmarkOutcome again = read_outcome<BenchmarkOutcome>(text);
  EXPECT_EQ(again.stop, StopReason::kTimeBudget);
  EXPECT_EQ(again.value, 1.0 / 3.0);
  EXPECT_TRUE(std::isnan(again.correlation));
  EXPECT_EQ(again.truth_value, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(report::json_line(again), text);
  EXPECT_EQ(
      read_outcome<BenchmarkOutcome>(report::json_line(BenchmarkOutcome{.failure = "why"})).failure,
      "why");
  for (const char* wrong : {"", "{}", "[]", R"({"stop": "tired"})"}) {
    EXPECT_THROW(read_outcome<BenchmarkOutcome>(wrong), InvalidInput) << wrong;
  }
}

TEST(BenchmarkOutcome, TellsAWrongMinimumFromALocalOne) {
  BenchmarkOutcome outcome{.stop = StopReason::kConverged};
  outcome.value = 1.0;
  outcome.truth_value = 2.0;
  EXPECT_THAT(reason_of(outcome), HasSubstr("the objective's minimum lies elsewhere"));
  outcome.value = 3.0;
  EXPECT_THAT(reason_of(outcome), HasSubstr("ended in a minimum above"));
  outcome.stop = StopReason::kEvaluationBudget;
  EXPECT_THAT(reason_of(outcome), HasSubstr("cut by the budget"));
  outcome.success = true;
  EXPECT_EQ(reason_of(outcome), "");
}

}  // namespace
}  // namespace modcal::benchmark_summary_test
