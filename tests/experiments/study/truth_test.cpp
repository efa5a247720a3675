#include "experiments/study/truth.hpp"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>

#include "experiments/kinds/sweep_study.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

TruthOptions short_truth() {
  TruthOptions options;
  options.scene = paper_scene();
  options.scene.duration = 0.05;
  return options;
}

TEST(TruthCache, SimulatesADistinctSceneOnceForAllThreads) {
  TruthCache cache;
  std::array<std::shared_ptr<const Truth>, 16> truths;
  tbb::parallel_for(0, 16, [&](int i) {
    TruthOptions options = short_truth();
    options.scene.bow.normal_force = i % 2 == 0 ? 1.0 : 1.1;
    truths[static_cast<std::size_t>(i)] = cache.get(options, 51200.0, {.force = true});
  });
  EXPECT_EQ(cache.simulated(), 2u);
  EXPECT_EQ(truths[0], truths[14]);
  EXPECT_NE(truths[0], truths[1]);
  EXPECT_EQ(truths[0]->simulation.force.size(), 2560u);
  EXPECT_TRUE(truths[0]->simulation.velocity.samples.empty());
}

TEST(TruthCache, TellsEveryWaiterWhyASceneCannotBeSimulated) {
  TruthCache cache;
  TruthOptions options = short_truth();
  options.scene.bow.position = 1.0;
  EXPECT_THROW(cache.get(options, 51200.0, {}), InvalidInput);
  EXPECT_THROW(cache.get(options, 51200.0, {}), InvalidInput);
}

// Cells give the same bits whatever the threads, and a failing cell is counted, not lost.
TEST(RunCells, KeepsOrderAndCountsFailures) {
  std::vector<SweepCell> cells(6);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    InvertOptions& options = cells[i].options;
    options.observation.has_scene = true;
    options.observation.truth = short_truth();
    options.observation.measurement.noise_level = 0.01 * static_cast<double>(i);
    options.score.windows = {i == 4 ? 0.2 : 0.03};  // 0.2 s is beyond the record
  }
  SharedWork work;
  const StudyContext context{.work = work};
  const auto outcomes = run_cells(cells, context);
  const auto again = run_cells(cells, context);
  ASSERT_EQ(outcomes.size(), 6u);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    EXPECT_EQ(outcomes[i].failure.empty(), i != 4);
    if (i == 4) continue;
    ASSERT_EQ(outcomes[i].sides.size(), 2u);
    EXPECT_EQ(outcomes[i].sides[0].scores[0].correlation, again[i].sides[0].scores[0].correlation);
  }
  EXPECT_EQ(work.truths.simulated(), 1u);
}

TEST(RunCells, StopsWhenInterrupted) {
  std::vector<SweepCell> cells(3);
  SharedWork work;
  EXPECT_THROW(run_cells(cells, {.work = work, .interrupted = [] { return true; }}), Interrupted);
}

}  // namespace
}  // namespace modcal
