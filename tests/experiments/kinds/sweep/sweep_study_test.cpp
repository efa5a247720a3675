#include "experiments/kinds/sweep/sweep_study.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libinverse/observer/observer_estimator.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

SweepCell cell_with(double noise_level, double window) {
  SweepCell cell;
  cell.options.observation.has_scene = true;
  cell.options.observation.truth.scene = paper_scene();
  cell.options.observation.truth.scene.duration = 0.05;
  cell.options.observation.measurement.noise_level = noise_level;
  cell.options.score.windows = {window};
  cell.row_value = noise_level;
  return cell;
}

TEST(RunCell, GivesTheSameBitsAgainFromOneSimulation) {
  SharedWork work;
  const StudyContext context{.work = work};
  const TaskOutcome outcome = run_cell(cell_with(0.02, 0.03), context);
  const TaskOutcome again = run_cell(cell_with(0.02, 0.03), context);
  ASSERT_EQ(outcome.sides.size(), 2u);
  EXPECT_EQ(outcome_text(outcome), outcome_text(again));
  EXPECT_NE(outcome_text(outcome), outcome_text(run_cell(cell_with(0.03, 0.03), context)));
  EXPECT_EQ(work.truths.simulated(), 1u);
}

TEST(RunCell, PutsAFailureIntoItsOutcome) {
  SharedWork work;
  // The window is beyond the record.
  const TaskOutcome outcome = run_cell(cell_with(0.0, 0.2), {.work = work});
  EXPECT_FALSE(outcome.failure.empty());
  EXPECT_TRUE(outcome.sides.empty());
}

// The model-based estimate as one of the sweep's estimators, beside the linear limit of the same
// draw: 0.1 s at 5 % noise.
TEST(RunCell, TakesTheModelBasedEstimateForAnEstimator) {
  SweepCell cell = cell_with(0.05, 0.08);
  cell.options.observation.truth.scene.duration = 0.1;
  cell.options.observation.truth.simulator.select("modal_event");
  cell.options.score.whole = {0.02, 0.095};
  cell.options.score.oversampling = 4;
  ModelBasedOptions options;
  options.substeps = 4;
  options.rounds = 1;
  cell.options.inversion.estimator =
      Choice<Estimator>::of<ObserverEstimator>("model_based", options);
  SharedWork work;
  const StudyContext context{.work = work};
  const TaskOutcome model = run_cell(cell, context);
  cell.options.inversion.estimator.select("linear_limit");
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
  const StudyResult table = sum_up_sweep({}, {}, {cell, cell}, {model, limit}, context);
  EXPECT_NE(table.summary.find("model "), std::string::npos);
}

TEST(SumUpSweep, CountsWhatFailedAndWhatIsNotRunYet) {
  SharedWork work;
  const StudyContext context{.work = work};
  const std::vector<SweepCell> cells = {cell_with(0.0, 0.03), cell_with(0.0, 0.2),
                                        cell_with(0.01, 0.03)};
  const StudyResult part = sum_up_sweep(
      {}, {}, cells, {run_cell(cells[0], context), run_cell(cells[1], context), std::nullopt},
      context);
  EXPECT_EQ(part.failed_tasks, 1u);
  EXPECT_EQ(part.pending_tasks, 1u);
  EXPECT_EQ(part.status, report::Status::kSomeFailed);
  const StudyResult none = sum_up_sweep({}, {}, {cells[1]}, {run_cell(cells[1], context)}, context);
  EXPECT_EQ(none.status, report::Status::kFailed);
}

}  // namespace
}  // namespace modcal
