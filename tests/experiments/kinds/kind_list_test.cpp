// Any kind of experiment over axes: a list of tasks like any other.
#include "experiments/kinds/kind_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/experiments/kinds/list_case.hpp"
#include "tests/folder_test.hpp"

namespace modcal::kind_list_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kSimulate = "kind: simulate\n" + std::string(kListScene) + R"(
measurement: {sample_rate: 12.5 kHz}
sweep:
  product:
    scene.initial.displacement: [1 mm, 2 mm]
    seed: [1, 2]
)";
const std::string kIdentify = "kind: identify\n" + std::string(kListScene) + R"(
identification: {highest_frequency: 900 Hz}
sweep:
  product:
    measurement.noise_level: [0.5 %, 1 %]
)";

std::map<std::string, double> numbers_of(const std::string& outcome) {
  const auto numbers = read_outcome<RunOutcome>(outcome).numbers;
  return {numbers.begin(), numbers.end()};
}

TEST(KindList, SimulatesOverAnAxis) {
  const LoadedExperiment loaded = loaded_from(kSimulate);
  const TaskExperiment& list = list_of(loaded);
  ASSERT_EQ(list.task_count(), 4u);
  EXPECT_THAT(list.axis_values(2), ElementsAre("2 mm", "1"));
  SharedWork work;
  const auto single = numbers_of(list.run_task(0, {.work = work}));
  const auto twice = numbers_of(list.run_task(2, {.work = work}));
  // A linear string: twice the displacement, twice the reactions.
  EXPECT_NEAR(twice.at("levels.R1.std") / single.at("levels.R1.std"), 2.0, 1e-9);
  EXPECT_EQ(single.at("simulation.steps"), twice.at("simulation.steps"));
  const StudyResult result = list.run({.work = work});
  EXPECT_THAT(result.summary, HasSubstr("4 of 4 tasks done, 0 failed; 2 settings"));
  ASSERT_EQ(result.files.size(), 1u);
  EXPECT_THAT(result.files[0].second, HasSubstr("levels.R1.std"));
}

TEST(KindList, TellsWhatItsRunsWereWarnedOf) {
  const LoadedExperiment loaded = loaded_from(kSimulate);
  TaskOutcomes outcomes(4);
  for (std::size_t task = 0; task < 4; ++task) {
    StudyResult run;
    if (task % 2 == 1) run.warn(fmt::format("the reactions contradict each other {} times", task));
    outcomes.put(task, {.outcome = report::json_line(run_outcome(run)), .seconds = 0.1});
  }
  const StudyResult result = sum_up_runs(list_of(loaded), outcomes);
  EXPECT_THAT(result.warnings,
              ElementsAre("2 tasks (1, 3): the reactions contradict each other 1 times"));
  EXPECT_THAT(result.files.at(0).second, HasSubstr("the reactions contradict each other 3 times"));
}

TEST(KindList, IdentifiesOverAnAxis) {
  const LoadedExperiment loaded = loaded_from(kIdentify);
  const TaskExperiment& list = list_of(loaded);
  ASSERT_EQ(list.task_count(), 2u);
  SharedWork work;
  const StudyResult result = list.run({.work = work});
  EXPECT_EQ(result.failed_tasks, 0u) << result.files.at(0).second;
  ASSERT_TRUE(std::holds_alternative<report::Figure>(result.blocks.at(0)));
  const auto& figure = std::get<report::Figure>(result.blocks[0]);
  EXPECT_THAT(figure.panels.at(0).series.at(0).x, ElementsAre(0.5, 1.0));
  EXPECT_EQ(figure.panels[0].x.unit, "%");
}

// Words have no place on an axis: their medians are maps, the largest number dark.
TEST(KindList, TwoAxesOfWordsMakeMaps) {
  const LoadedExperiment loaded = loaded_from(R"(kind: invert
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10, damping: {type: constant, ratio: 2e-3}}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  duration: 0.2 s
measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}
inversion: {estimator: one_sided}
sweep:
  product:
    inversion.regularizer: [tikhonov, wiener, water_level]
    inversion.parameter_choice: [gcv, evidence]
)");
  const TaskExperiment& list = list_of(loaded);
  SharedWork work;
  const StudyResult result = list.run({.work = work, .folder = ".", .command = {}, .stop = {}});
  ASSERT_GT(result.first_screen, 0u);
  ASSERT_LT(result.first_screen, result.blocks.size());
  std::size_t maps = 0;
  for (std::size_t i = 0; i < result.first_screen; ++i) {
    const auto* map = std::get_if<report::Table>(&result.blocks[i]);
    if (map == nullptr) continue;  // what the runs were warned of
    ++maps;
    ASSERT_EQ(map->rows.size(), 3u);
    ASSERT_EQ(map->columns.size(), 3u);
    EXPECT_EQ(map->columns[2].key, "evidence");
    double lightest = 1.0, darkest = 0.0;
    for (const auto& row : map->rows) {
      for (std::size_t j = 1; j < row.size(); ++j) {
        if (row[j].heat < 0.0) continue;  // no number
        lightest = std::min(lightest, row[j].heat);
        darkest = std::max(darkest, row[j].heat);
      }
    }
    EXPECT_EQ(lightest, 0.0) << map->title;
    EXPECT_EQ(darkest, 1.0) << map->title;
  }
  EXPECT_EQ(result.first_screen - maps, result.warnings.size());
  EXPECT_GT(maps, 1u);
}

TEST(KindList, ReplaysATaskAsTheExperimentThatItIs) {
  const LoadedExperiment loaded = loaded_from(kSimulate);
  SharedWork work;
  const StudyResult again = list_of(loaded).replay(2, {.work = work});
  const std::string alone = kSimulate.substr(0, kSimulate.find("sweep:"));
  YamlDocument document = parse_yaml(alone, "test.yaml");
  apply_assignment(document, "scene.initial.displacement=2 mm", 1);
  const StudyResult one = load_experiment(std::move(document)).experiment->run({.work = work});
  EXPECT_EQ(again.summary, one.summary);
  EXPECT_EQ(run_outcome(again).numbers, run_outcome(one).numbers);
}

TEST(KindList, MakesNoFiguresAndSignalsThatNobodyReads) {
  const LoadedExperiment loaded = loaded_from("kind: invert\n" + std::string(kListScene) +
                                              "measurement: {sample_rate: 12.5 kHz}\n");
  ASSERT_NE(loaded.experiment, nullptr) << format_mistakes(loaded.document, loaded.mistakes);
  SharedWork work;
  const auto figures = [](const StudyResult& result) {
    return std::ranges::count_if(result.blocks, [](const report::Block& block) {
      return std::holds_alternative<report::Figure>(block);
    });
  };
  const StudyResult full = loaded.experiment->run({.work = work});
  EXPECT_GT(figures(full), 0);
  EXPECT_EQ(full.signal_files.size(), 1u);
  const StudyResult quiet = loaded.experiment->run({.work = work, .numbers_alone = true});
  EXPECT_EQ(figures(quiet), 0);
  EXPECT_EQ(quiet.signal_files.size(), 0u);
  EXPECT_EQ(run_outcome(quiet).numbers, run_outcome(full).numbers);
}

class KindListStore : public FolderTest {};

TEST_F(KindListStore, GoesOnWhereItEnds) {
  const LoadedExperiment loaded = loaded_from(kSimulate);
  const TaskExperiment& list = list_of(loaded);
  SharedWork work;
  const StudyContext context{.work = work, .folder = folder()};
  {
    RunStore store(folder(), {1, 2}, "p");
    const TaskOutcomes half = run_tasks(list, context, &store, {1, 2});
    EXPECT_EQ(list.sum_up(half, context).pending_tasks, 2u);
  }
  // What is finished is found again under an edited list, too.
  std::string edited = kSimulate;
  edited.replace(edited.find("[1, 2]"), 6, "[3, 1]");
  const LoadedExperiment other = loaded_from(edited);
  const FinishedTasks finished(folder(), "p");
  const TaskOutcomes found = stored_outcomes(list_of(other), finished, folder());
  EXPECT_FALSE(found.has(0));
  EXPECT_TRUE(found.has(1));
}

TEST(KindList, IsTheExperimentItselfWithoutAxes) {
  const LoadedExperiment loaded = loaded_from(kSimulate.substr(0, kSimulate.find("sweep:")));
  ASSERT_NE(loaded.experiment, nullptr);
  EXPECT_EQ(dynamic_cast<const TaskExperiment*>(loaded.experiment.get()), nullptr);
}

TEST(KindList, FindsTheMistakesOfItsCells) {
  std::string wrong = kSimulate;
  wrong.replace(wrong.find("scene.initial.displacement"), 26, "scene.initial.displacment");
  const LoadedExperiment loaded = loaded_from(wrong);
  EXPECT_EQ(loaded.experiment, nullptr);
  EXPECT_THAT(format_mistakes(loaded.document, loaded.mistakes), HasSubstr("displacment"));
}

TEST(KindList, ShowsAMistakeAtTheValueOfTheAxis) {
  std::string wrong = kSimulate;
  wrong.replace(wrong.find("[1 mm, 2 mm]"), 12,
                "[1 mm, 2 mm]\n    scene.initial.position: [43 mm, 400 mm]");
  const LoadedExperiment loaded = loaded_from(wrong);
  ASSERT_EQ(loaded.mistakes.size(), 1u) << format_mistakes(loaded.document, loaded.mistakes);
  const std::size_t at = wrong.find("400 mm"), line = wrong.rfind('\n', at);
  EXPECT_EQ(loaded.mistakes[0].position.column, at - line);
}

TEST(RunOutcome, HasTheNumbersOfTheTables) {
  report::Table one{.id = "fit", .columns = {{.key = "f0"}, {.key = "method"}}};
  one.rows = {{196.0, "eigen"}};
  report::Table several{.id = "modes", .columns = {{.key = "n"}, {.key = "f"}}};
  several.rows = {{1, 100.0}, {2, report::Cell()}, {2, 7}};
  StudyResult result;
  result.blocks = {one, several};
  const RunOutcome outcome = run_outcome(result);
  EXPECT_THAT(outcome.numbers,
              ElementsAre(std::pair("fit.f0", 196.0), std::pair("modes.1.f", 100.0),
                          std::pair("modes.2.2.f", 7.0)));
  EXPECT_THAT(outcome.failure, IsEmpty());
  result.status = report::Status::kFailed;
  result.summary = "nothing was identified";
  EXPECT_EQ(run_outcome(result).failure, "nothing was identified");
}

}  // namespace
}  // namespace modcal::kind_list_test
