#include <gtest/gtest.h>

#include <cmath>

#include "experiments/kinds/sweep/sweep.hpp"
#include "experiments/runs/task_experiment.hpp"
#include "libinverse/observer/model_based_estimator.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::sweep_study_test {
namespace {

InvertOptions cell_with(double noise_level, double window) {
  InvertOptions cell;
  cell.observation.has_scene = true;
  cell.observation.truth.scene = paper_scene();
  cell.observation.truth.scene.duration = 0.05;
  cell.observation.measurement.noise_level = noise_level;
  cell.score.windows = {window};
  cell.inversion.estimator.select("one_sided");
  return cell;
}

TEST(RunCell, GivesTheSameBitsAgainFromOneSimulation) {
  SharedWork work;
  const StudyContext context{.work = work};
  const TaskOutcome outcome = run_cell(cell_with(0.02, 0.03), context);
  const TaskOutcome again = run_cell(cell_with(0.02, 0.03), context);
  ASSERT_EQ(outcome.sides.size(), 2u);
  EXPECT_EQ(report::json_line(outcome), report::json_line(again));
  EXPECT_NE(report::json_line(outcome),
            report::json_line(run_cell(cell_with(0.03, 0.03), context)));
  EXPECT_EQ(work.truths.simulated(), 1u);
}

TEST(RunCell, PutsAFailureIntoItsOutcome) {
  SharedWork work;
  // The window is beyond the record.
  const TaskOutcome outcome =
      attempted([&] { return run_cell(cell_with(0.0, 0.2), {.work = work}); });
  EXPECT_FALSE(outcome.failure.empty());
  EXPECT_TRUE(outcome.sides.empty());
}

// The model-based estimate as one of the sweep's estimators, beside the linear limit of the same
// draw: 0.1 s at 5 % noise.
TEST(RunCell, TakesTheModelBasedEstimateForAnEstimator) {
  InvertOptions cell = cell_with(0.05, 0.08);
  cell.observation.truth.scene.duration = 0.1;
  cell.observation.truth.simulator.select("modal_event");
  cell.score.whole = {0.02, 0.095};
  cell.score.oversampling = 4;
  ModelBasedOptions options;
  options.substeps = 4;
  options.rounds = 1;
  cell.inversion.estimator = Choice<Estimator>::of<ModelBasedEstimator>("model_based", options);
  SharedWork work;
  const StudyContext context{.work = work};
  const TaskOutcome model = run_cell(cell, context);
  cell.inversion.estimator.select("linear_limit");
  const TaskOutcome limit = run_cell(cell, context);
  ASSERT_EQ(model.failure, "");
  ASSERT_EQ(model.sides.size(), 1u);
  const TaskScores& scores = model.sides[0];
  EXPECT_EQ(scores.side, "model");
  // Measured 0.97 against 0.88; a model-based force that is not better is none.
  EXPECT_GT(scores.whole.correlation, limit.sides[0].whole.correlation + 0.03);
  EXPECT_GT(scores.whole.anti_aliased, 0.95);
  EXPECT_LT(scores.whole.relative_rms_error, limit.sides[0].whole.relative_rms_error);
  EXPECT_NEAR(scores.misfit, 1.0, 0.2);
  EXPECT_TRUE(std::isnan(limit.sides[0].misfit));
  StudyResult table;
  sum_up_sweep({}, {},
               {{.noise_level = 0.05, .estimator = "model_based", .outcome = model},
                {.task = 1, .noise_level = 0.05, .estimator = "linear_limit", .outcome = limit}},
               context, table);
  EXPECT_NE(table.summary.find("model "), std::string::npos);
}

TaskOutcome outcome_of(double correlation) {
  return {.sides = {{.side = "1", .scores = {{.correlation = correlation}}}}};
}

// Two regularizers are two rows; forces of the bow are draws of one, and that is said.
TEST(SumUpSweep, TellsMethodsApartAndSaysWhatItPools) {
  SharedWork work;
  const StudyContext context{.work = work};
  StudyResult result;
  sum_up_sweep(
      {}, {"inversion.regularizer", "scene.bow.normal_force", "seed"},
      {{.estimator = "one_sided", .method = ", none", .outcome = outcome_of(0.1)},
       {.task = 1, .estimator = "one_sided", .method = ", tikhonov", .outcome = outcome_of(0.9)}},
      context, result);
  EXPECT_NE(result.summary.find("1, none"), std::string::npos) << result.summary;
  EXPECT_NE(result.summary.find("1, tikhonov"), std::string::npos) << result.summary;
  EXPECT_NE(result.summary.find("all values of scene.bow.normal_force together"),
            std::string::npos);
  EXPECT_EQ(result.summary.find("seed"), std::string::npos);
}

// Outcomes of a list of three tasks: one done, one failed, one not run yet.
TaskOutcomes some_outcomes(const StudyContext& context) {
  TaskOutcomes outcomes(3);
  std::size_t task = 0;
  for (const InvertOptions& cell : {cell_with(0.0, 0.03), cell_with(0.0, 0.2)}) {
    const TaskOutcome outcome = attempted([&] { return run_cell(cell, context); });
    outcomes.put(task++, FinishedTask{report::json_line(outcome)});
  }
  return outcomes;
}

StudyResult counted(const TaskOutcomes& outcomes, const StudyContext& context) {
  StudyResult result;
  std::vector<SweepTask> tasks;
  for_each_outcome<TaskOutcome>(
      outcomes, result, [&](std::size_t task, TaskOutcome outcome, double) {
        tasks.push_back({.task = task, .estimator = "one_sided", .outcome = std::move(outcome)});
      });
  sum_up_sweep({}, {}, tasks, context, result);
  return result;
}

TEST(SumUpSweep, CountsWhatFailedAndWhatIsNotRunYet) {
  SharedWork work;
  const StudyContext context{.work = work};
  const TaskOutcomes outcomes = some_outcomes(context);
  const StudyResult part = counted(outcomes, context);
  EXPECT_EQ(part.failed_tasks, 1u);
  EXPECT_EQ(part.pending_tasks, 1u);
  EXPECT_EQ(part.status, report::Status::kSomeFailed);
  EXPECT_EQ(part.failed_tasks, 1u);
  TaskOutcomes none(1);
  none.put(0, *outcomes[1]);
  EXPECT_EQ(counted(none, context).status, report::Status::kFailed);
}

}  // namespace
}  // namespace modcal::sweep_study_test
