#include "experiments/kinds/schelleng/schelleng.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/runs/task_experiment.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::schelleng_test {
namespace {

using testing::HasSubstr;

SchellengOptions small_map(std::int64_t positions, std::int64_t forces) {
  SchellengOptions options;
  options.scene = paper_scene();
  options.scene.duration = 0.5;
  options.positions.count = positions;
  options.forces.count = forces;
  return options;
}

std::vector<StringRegime> regimes(const SchellengOptions& options, const Simulator& simulator,
                                  const std::vector<std::size_t>& cells) {
  const Ensemble ensemble{.size = cells.size(),
                          .scene = [&](std::size_t i) { return options.cell_scene(cells[i]); },
                          .sample_rate = options.sample_rate,
                          .outputs = options.outputs()};
  return reduce_ensemble<StringRegime>(
      simulator, ensemble, [&](std::size_t i, const Simulation& simulation) {
        return judge_cell(options.cell_scene(cells[i]), simulation, options.criteria).regime;
      });
}

TEST(SchellengMap, AxesAreLogarithmic) {
  const MapAxis axis{0.01, 10.0, 3, "N"};
  const auto edges = axis.edges();
  ASSERT_EQ(edges.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(edges[i] / (0.01 * std::pow(10.0, i)), 1.0, 1e-14);
  EXPECT_NEAR(axis.center(1), std::sqrt(0.1 * 1.0), 1e-14);
}

TEST(SchellengMap, StoresEveryBitOfACell) {
  const CellOutcome outcome{.regime = StringRegime::kMultipleSlip,
                            .features = {2.05, 1.0 / 3.0, 1.0 + 1e-15, 0.1, 3e-300}};
  const CellOutcome read = read_outcome<CellOutcome>(report::json_line(outcome));
  EXPECT_EQ(read.regime, outcome.regime);
  EXPECT_EQ(read.features.slips_per_period, outcome.features.slips_per_period);
  EXPECT_EQ(read.features.periodicity, outcome.features.periodicity);
  EXPECT_EQ(read.features.period, outcome.features.period);
  EXPECT_EQ(read.features.adherence, outcome.features.adherence);
  EXPECT_EQ(read.features.amplitude, outcome.features.amplitude);
  EXPECT_EQ(read_outcome<CellOutcome>(R"({"failure":"too \"long\""})").failure, "too \"long\"");
  EXPECT_THROW(read_outcome<CellOutcome>("{}"), InvalidInput);
  EXPECT_THROW(read_outcome<CellOutcome>(R"({"motion":"loud"})"), InvalidInput);
}

// The known tolerance of Schelleng's limits is a factor of 2: they neglect the corner's width and,
// below, all harmonics but for their sum in the middle of the stick phase.
TEST(SchellengMap, HelmholtzMotionEndsAtSchellengsLimits) {
  SchellengOptions options = small_map(6, 24);
  options.positions.lowest = 0.03;
  options.positions.highest = 0.12;
  std::vector<std::size_t> cells(options.cells());
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = i;
  CellOutcomes outcomes;
  for (const StringRegime regime : regimes(options, *options.simulator.make(), cells)) {
    outcomes.push_back(CellOutcome{.regime = regime});
  }
  // Medians over the bow positions: a pocket of another motion may cut one of them short.
  std::vector<double> lowest, highest;
  for (const BorderRatios& ratios : border_ratios(options, outcomes)) {
    lowest.push_back(ratios.lowest);
    highest.push_back(ratios.highest);
  }
  for (const double median : {quantile(lowest, 0.5), quantile(highest, 0.5)}) {
    EXPECT_GT(median, 0.5);
    EXPECT_LT(median, 2.0);
  }
}

// Steps four times as short with the friction's slope kept four times as small. Cells beside a
// border may change sides: one in eight at the most.
TEST(SchellengMap, AgreesWithAFinerComputation) {
  const SchellengOptions options = small_map(8, 12);
  std::vector<std::size_t> cells;
  for (std::size_t i = 1; i < options.cells(); i += 3) cells.push_back(i);
  const auto coarse = regimes(options, *options.simulator.make(), cells);
  const auto fine = regimes(
      options, ModalEvent({.max_step = 0.25 / options.sample_rate, .slope_number = 0.175}), cells);
  std::size_t different = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) different += coarse[i] != fine[i] ? 1 : 0;
  EXPECT_LE(different, cells.size() / 8);
  for (std::size_t regime = 0; regime < 3; ++regime) {
    EXPECT_GT(std::count(fine.begin(), fine.end(), static_cast<StringRegime>(regime)), 2)
        << name_of(static_cast<StringRegime>(regime));
  }
}

TEST(SchellengMap, SumsUpWhatIsThere) {
  const SchellengOptions options = small_map(3, 2);
  CellOutcomes outcomes(6);
  outcomes[0] = CellOutcome{.regime = StringRegime::kHelmholtz};
  outcomes[4] = CellOutcome{.regime = StringRegime::kRaucous};
  outcomes[5] = CellOutcome{.failure = "chatter"};
  TaskOutcomes stored(6);
  for (std::size_t cell = 0; cell < 6; ++cell) {
    if (outcomes[cell]) stored.put(cell, FinishedTask{report::json_line(*outcomes[cell])});
  }
  SharedWork work;
  const StudyResult result = SchellengExperiment(options).sum_up(stored, {.work = work});
  EXPECT_EQ(result.pending_tasks, 3u);
  EXPECT_EQ(result.failed_tasks, 1u);
  EXPECT_EQ(result.status, report::Status::kSomeFailed);
  const auto figure = std::find_if(result.blocks.begin(), result.blocks.end(), [](const auto& b) {
    return std::holds_alternative<report::Figure>(b);
  });
  ASSERT_NE(figure, result.blocks.end());
  EXPECT_THAT(std::get<report::Figure>(*figure).panels[0].map->cells,
              testing::ElementsAre(0, -1, -1, -1, 2, -1));
  ASSERT_EQ(result.files.size(), 2u);
  EXPECT_THAT(result.files[0].second, HasSubstr("chatter"));
}

TEST(SchellengMap, ShowsOneCell) {
  const SchellengOptions options = small_map(2, 2);
  SharedWork work;
  const StudyResult result = SchellengExperiment(options).replay(1, {.work = work});
  EXPECT_EQ(result.status, report::Status::kOk);
  EXPECT_THAT(result.summary, HasSubstr("slips a period"));
  ASSERT_EQ(result.signal_files.size(), 1u);
  EXPECT_EQ(result.signal_files[0].signals.size(), 5u);
}

TEST(SchellengMap, RefusesWhatMakesNoMap) {
  SchellengOptions options = small_map(2, 2);
  EXPECT_TRUE(SchellengExperiment(options).lint().empty());
  const auto paths_of = [](const SchellengOptions& wrong) {
    std::vector<std::string> paths;
    for (const Finding& finding : SchellengExperiment(wrong).lint()) paths.push_back(finding.path);
    return paths;
  };
  SchellengOptions wrong = options;
  wrong.positions.highest = 0.6;
  EXPECT_THAT(paths_of(wrong), testing::Contains("positions.highest"));
  wrong = options;
  wrong.forces.highest = wrong.forces.lowest;
  EXPECT_THAT(paths_of(wrong), testing::Contains("forces"));
  wrong = options;
  wrong.scene.duration = 0.1;
  EXPECT_THAT(paths_of(wrong), testing::Contains("scene.duration"));
  wrong = options;
  wrong.scene.bow.velocity = 0.0;
  EXPECT_THAT(paths_of(wrong), testing::Contains("scene.bow.velocity"));
}

}  // namespace
}  // namespace modcal::schelleng_test
