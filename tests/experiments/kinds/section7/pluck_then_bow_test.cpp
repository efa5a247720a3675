// The route from a pluck test to the identified force, at a small size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"

namespace modcal::pluck_then_bow_test {
namespace {

using nlohmann::json;

// Fewer modes, a shorter record of a string that dies out in it, two loops.
YamlDocument small_case() {
  YamlDocument document = read_yaml_file(std::string(MODCAL_CONFIGS) + "/paper/section7.yaml");
  int line = 0;
  for (const char* assignment :
       {"scene.string.modes=20", "scene.duration=1 s",
        "scene.string.damping={type: polynomial, coefficients: [9.6e-4, 4e-5]}",
        "refinement.optimizer.loops=2", "contact.points=21"}) {
    apply_assignment(document, assignment, ++line);
  }
  return document;
}

StudyResult run(const LoadedExperiment& loaded) {
  SharedWork work;
  return loaded.experiment->run(
      {.work = work, .folder = loaded.document.folder(), .command = "test"});
}

// Run once for all tests.
const StudyResult& small_result() {
  static const StudyResult result = run(load_experiment(small_case()));
  return result;
}

json outcome_of(const StudyResult& result) { return json::parse(result.files.at(0).second); }

const json& step(const json& steps, const std::string& key) {
  for (const json& entry : steps) {
    if (entry["step"] == key) return entry;
  }
  throw std::out_of_range(key);
}

TEST(PluckThenBow, TakesEveryStepOfTheRoute) {
  const LoadedExperiment loaded = load_experiment(small_case());
  ASSERT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
  const StudyResult& result = small_result();
  EXPECT_EQ(result.status, report::Status::kOk);
  const json document = outcome_of(result);
  std::vector<std::string> keys;
  for (const json& entry : document["steps"]) keys.push_back(entry["step"]);
  EXPECT_THAT(keys, testing::ElementsAre("pluck", "first_refined", "law", "refined", "law_again",
                                         "contact"));
  EXPECT_EQ(document["pluck"]["modes"].size(), 11u);
  const json& plucked = step(document["steps"], "pluck");
  const json& first = step(document["steps"], "first_refined");
  ASSERT_EQ(plucked["f_hz"].size(), 11u);
  for (std::size_t n = 0; n < 11; ++n) {
    // Only the first five move, and by no more than the range of the search.
    const double share = first["f_hz"][n].get<double>() / plucked["f_hz"][n].get<double>() - 1.0;
    if (n < 5) {
      EXPECT_LE(std::abs(share), 0.04);
    } else {
      EXPECT_EQ(share, 0.0);
    }
  }
  EXPECT_EQ(step(document["steps"], "law")["f_hz"].size(), 20u);
  EXPECT_EQ(step(document["steps"], "refined")["f_hz"].size(), 20u);
  // The bracket is one point of the curve wide, 0.3 mm.
  EXPECT_NEAR(step(document["steps"], "contact")["x_c_m"].get<double>(), 28.5e-3, 1.5e-3);
  EXPECT_EQ(document["identification"].size(), 2u);
  EXPECT_THAT(result.summary, testing::HasSubstr("standard deviations (rms) off the pluck test"));
}

TEST(PluckThenBow, ThePluckTestSharpensTheCalibrationToTheBound) {
  const json document = outcome_of(small_result());
  EXPECT_TRUE(document["bound_right"].get<bool>());
  const json& bound = step(document["bound_steps"], "bound");
  const json& posterior = step(document["bound_steps"], "posterior");
  for (const auto& [value, deviation] :
       {std::pair("f0_hz", "f0_sd_hz"), std::pair("B", "B_sd"), std::pair("x_c_m", "x_c_sd_m")}) {
    const double truth = document["truth"][value].get<double>();
    const double sd = posterior[deviation].get<double>();
    EXPECT_GT(sd, 0.0);
    // More data: no parameter is known less well.
    EXPECT_LE(sd, bound[deviation].get<double>()) << value;
    EXPECT_LE(std::abs(posterior[value].get<double>() - truth), 5.0 * sd) << value;
  }
  // The pluck test sees f_1 far more sharply than the stroke does.
  EXPECT_LT(posterior["f0_sd_hz"].get<double>(), 0.5 * bound["f0_sd_hz"].get<double>());
}

TEST(PluckThenBow, TellsWrongPriorsFromAWrongFit) {
  // The stroke knows x_c to a micrometer; this prior, ten deviations off, moves it by a tenth of
  // one, which χ² does not see.
  YamlDocument document = small_case();
  apply_assignment(document,
                   "bound.parameters={priors: [{parameter: x_c, mean: 28.6 mm, deviation: 10 um}]}",
                   9);
  const LoadedExperiment loaded = load_experiment(std::move(document));
  ASSERT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
  const StudyResult result = run(loaded);
  const json outcome = outcome_of(result);
  EXPECT_FALSE(outcome["bound_right"].get<bool>());
  EXPECT_TRUE(outcome["bound_fits"].get<bool>());
  EXPECT_TRUE(outcome["bound_priors_contradicted"].get<bool>());
  EXPECT_THAT(result.summary, testing::HasSubstr("the data do not contradict the fit"));
  EXPECT_THAT(result.summary,
              testing::HasSubstr("THE PRIORS ARE CONTRADICTED BY THE DATA; farthest: x_c"));
  EXPECT_THAT(result.summary, testing::Not(testing::HasSubstr("THE FIT IS WRONG")));
}

TEST(PluckThenBow, RefusesWhatCannotBeDone) {
  YamlDocument document = small_case();
  apply_assignment(document, "pluck.initial=rest", 9);
  apply_assignment(document, "contact.range=40 mm", 10);
  const LoadedExperiment loaded = load_experiment(std::move(document));
  const std::string mistakes = format_mistakes(loaded.document, loaded.mistakes);
  EXPECT_THAT(mistakes, testing::HasSubstr("has no free decay"));
  EXPECT_THAT(mistakes, testing::HasSubstr("leaves the string"));

  YamlDocument few = small_case();
  apply_assignment(few, "refinement.law_modes=15", 9);
  const LoadedExperiment too_few = load_experiment(std::move(few));
  ASSERT_NE(too_few.experiment, nullptr);
  EXPECT_THROW(run(too_few), InvalidInput);
}

}  // namespace
}  // namespace modcal::pluck_then_bow_test
