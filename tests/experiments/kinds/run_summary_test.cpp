// What is told and drawn of the runs of a list.
#include "experiments/kinds/run_summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/experiments/kinds/list_case.hpp"

namespace modcal::run_summary_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Outcomes of a list whose task t leaves x = t, and y as well where t is even.
StudyResult summed_up(const TaskExperiment& list) {
  TaskOutcomes outcomes(list.task_count());
  for (std::size_t task = 0; task < list.task_count(); ++task) {
    RunOutcome outcome{.numbers = {{"t.x", static_cast<double>(task)}}, .units = {{"t.x", "N"}}};
    if (task % 2 == 0) outcome.numbers.emplace_back("t.y", static_cast<double>(task));
    outcomes.put(task, {.outcome = report::json_line(outcome), .seconds = 0.1});
  }
  return sum_up_runs(list, outcomes);
}

std::string sweep_of(const std::string& sweep) {
  return "kind: simulate\n" + std::string(kListScene) +
         "measurement: {sample_rate: 12.5 kHz}\nsweep: " + sweep + "\n";
}

template <typename Kind>
const Kind& first_of(const StudyResult& result) {
  for (const report::Block& block : result.blocks) {
    if (const auto* found = std::get_if<Kind>(&block)) return *found;
  }
  throw std::out_of_range("no such block");
}

// An added cell has no value on the axes: its place on a map has a name.
TEST(RunSummary, DrawsACellThatIsOnNoAxis) {
  const LoadedExperiment loaded =
      loaded_from(sweep_of("{product: {scene.initial.displacement: [1 mm, 2 mm]}, include: "
                           "[{scene.bow.position: 45 mm}]}"));
  const StudyResult result = summed_up(list_of(loaded));
  const auto& figure = first_of<report::Figure>(result);
  EXPECT_THAT(figure.panels.at(0).series.at(0).x, ElementsAre(1.0, 2.0));
  const LoadedExperiment words = loaded_from(sweep_of(
      "{product: {simulator.type: [modal_exact]}, include: [{scene.bow.position: 45 mm}]}"));
  const StudyResult of_words = summed_up(list_of(words));
  const auto& map = first_of<report::Table>(of_words);
  EXPECT_EQ(map.columns.at(0).key, "t.x [N] by simulator.type");
  EXPECT_EQ(map.columns.at(1).key, "as stated");
  EXPECT_NO_THROW(report::check_table(map));
}

TEST(RunSummary, CountsTheDrawsThatHaveANumber) {
  const LoadedExperiment loaded =
      loaded_from(sweep_of("{product: {scene.initial.displacement: [1 mm, 2 mm], seed: [1, 2]}}"));
  const StudyResult result = summed_up(list_of(loaded));
  const auto& settings = first_of<report::Table>(result);
  std::vector<std::string> keys;
  for (const report::Column& column : settings.columns) keys.push_back(column.key);
  EXPECT_THAT(keys,
              ElementsAre("scene.initial.displacement", "n", "failures", "t.x", "t.y", "t.y.n"));
  EXPECT_EQ(std::get<std::int64_t>(settings.rows.at(1).back().value), 1);
}

TEST(RunSummary, DrawsAnAxisOfSeveralUnits) {
  const LoadedExperiment loaded =
      loaded_from(sweep_of("{product: {scene.bow.normal_force: [0.5 N, 800 mN, 1 N], "
                           "measurement.noise_level: [1 %, 0.02]}}"));
  const StudyResult result = summed_up(list_of(loaded));
  const auto& figure = first_of<report::Figure>(result);
  EXPECT_THAT(figure.panels.at(0).series.at(0).x, ElementsAre(0.5, 0.8, 1.0));
  EXPECT_EQ(figure.panels[0].x.unit, "N");
  EXPECT_THAT(report::figure_csv(figure), HasSubstr("t.x: noise_level 1 % [N]"));
}

TEST(RunSummary, HasNothingOfWhatItTook) {
  StudyResult run;
  run.add(report::tables_of([](ResultVisitor& visitor) {
    visitor.group({.table = "search"}, [](ResultVisitor& row) {
      row({.key = "evaluations"}, 7);
      row({.key = "seconds", .unit = "s", .is_effort = true}, 0.5);
    });
  }));
  ASSERT_EQ(run_outcome(run).numbers.size(), 1u);
  EXPECT_EQ(run_outcome(run).numbers[0].first, "search.evaluations");
}

}  // namespace
}  // namespace modcal::run_summary_test
