#include "experiments/kinds/sweep_study.hpp"

#include <gtest/gtest.h>

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
