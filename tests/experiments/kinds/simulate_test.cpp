// What the kind "simulate" says of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"

namespace modcal::simulate_test {
namespace {

struct RunSteps {
  std::int64_t steps = 0, refined = 0;
  std::string summary;
};

std::int64_t cell_of(const report::Table& table, std::string_view key) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].key == key) return std::get<std::int64_t>(table.rows.at(0)[i].value);
  }
  throw std::out_of_range(std::string(key));
}

// A tenth of the scene, its bow not lifted yet.
RunSteps run_with(const std::string& tail_ratio) {
  YamlDocument document = read_yaml_file(std::string(MODCAL_CONFIGS) + "/scenes/bow_change.yaml");
  apply_assignment(document, "scene.duration=0.1 s", 0);
  apply_assignment(document, "figures=[]", 1);
  apply_assignment(document, "simulator.tail_ratio=" + tail_ratio, 2);
  const LoadedExperiment loaded = load_experiment(std::move(document));
  EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
  SharedWork work;
  const StudyResult result =
      loaded.experiment->run({.work = work, .folder = loaded.document.folder(), .command = "test"});
  for (const report::Block& block : result.blocks) {
    const auto* table = std::get_if<report::Table>(&block);
    if (!table || table->id != "simulation") continue;
    return {cell_of(*table, "steps"), cell_of(*table, "refined_steps"), result.summary};
  }
  throw std::out_of_range("no table of the run");
}

TEST(Simulate, SaysHowManyStepsWereTakenBack) {
  const RunSteps stated = run_with("0.3"), strict = run_with("0.1"), loose = run_with("1000");
  EXPECT_GT(stated.refined, 0);
  EXPECT_GT(strict.refined, stated.refined);
  EXPECT_LT(loose.refined, stated.refined);
  EXPECT_GT(strict.steps, stated.steps);
  EXPECT_THAT(stated.summary,
              testing::HasSubstr(fmt::format("({} taken back for shorter ones)", stated.refined)));
}

std::string answer_of(const std::string& scene, const std::vector<std::string>& assignments) {
  YamlDocument document = read_yaml_file(std::string(MODCAL_CONFIGS) + "/scenes/" + scene);
  for (std::size_t i = 0; i < assignments.size(); ++i) {
    apply_assignment(document, assignments[i], i);
  }
  const LoadedExperiment loaded = load_experiment(std::move(document));
  EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
  SharedWork work;
  return loaded.experiment
      ->run({.work = work, .folder = loaded.document.folder(), .command = "test"})
      .answer;
}

TEST(Simulate, SaysWhatTheStringDid) {
  using testing::HasSubstr;
  using testing::StartsWith;
  const std::string event = "simulator={type: modal_event}";
  EXPECT_THAT(answer_of("torsion.yaml", {}),
              AllOf(StartsWith("Helmholtz motion at 196"), HasSubstr("one slip a period"),
                    HasSubstr("under 1 N of the bow")));
  EXPECT_THAT(answer_of("hyperbolic.yaml", {}), StartsWith("Multiple slip at 196"));
  EXPECT_THAT(answer_of("hyperbolic.yaml",
                        {event, "scene.bow.normal_force=50 N", "scene.bow.velocity=1 cm/s"}),
              StartsWith("The bow holds the string without a slip"));
  EXPECT_THAT(answer_of("hyperbolic.yaml", {event, "scene.bow.normal_force=1 mN"}),
              StartsWith("The string slides under the bow"));
  EXPECT_THAT(answer_of("hyperbolic.yaml", {event, "scene.bow.velocity=0 m/s"}),
              "The bow stands still on the string");
  EXPECT_THAT(answer_of("pluck.yaml", {}),
              StartsWith("The string rings freely at 196.01 Hz, falling"));
  EXPECT_THAT(answer_of("bow_lifted.yaml", {}), StartsWith("The string rings freely at 196.01 Hz"));
  EXPECT_THAT(answer_of("bow_change.yaml", {}), StartsWith("The bow changes until the end"));
  EXPECT_THAT(answer_of("torsion.yaml", {"scene.duration=0.1 s", "figures=[]"}),
              HasSubstr("this is 0.1 s of it"));
}

TEST(Simulate, DrawsTheLastPeriodsWhereNothingIsAskedFor) {
  YamlDocument document = read_yaml_file(std::string(MODCAL_CONFIGS) + "/scenes/pluck.yaml");
  apply_assignment(document, "figures=[]", 0);
  const LoadedExperiment loaded = load_experiment(std::move(document));
  SharedWork work;
  StudyResult result =
      loaded.experiment->run({.work = work, .folder = loaded.document.folder(), .command = "test"});
  const auto [first, details] = result.take_parts();
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(std::get<report::Figure>(first[0]).panels.size(), 3u);  // y, R1, R2
  EXPECT_EQ(std::get<report::Table>(first[1]).id, "levels");
}

}  // namespace
}  // namespace modcal::simulate_test
