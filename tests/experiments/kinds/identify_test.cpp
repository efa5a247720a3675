// Kind "identify": the modes of the plucked string, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"

namespace modcal::identify_test {
namespace {

const std::string kConfig = std::string(MODCAL_CONFIGS) + "/calibration/pluck.yaml";

TEST(IdentifyPluck, FindsTheElevenModesOfTheStringWithinTheirErrorBars) {
  const LoadedExperiment loaded = load_experiment(kConfig);
  ASSERT_NE(loaded.experiment, nullptr) << format_mistakes(loaded.document, loaded.mistakes);
  SharedWork work;
  const StudyResult result =
      loaded.experiment->run({.work = work, .folder = loaded.document.folder(), .command = "test"});
  EXPECT_EQ(result.status, report::Status::kOk);
  const auto document = nlohmann::json::parse(result.files.at(0).second);
  ASSERT_EQ(document["modes"].size(), 11u);
  EXPECT_TRUE(document["missing"].empty());
  double square = 0.0, of_ratios = 0.0;
  for (const auto& mode : document["modes"]) {
    const double off = mode["f_hz"].get<double>() - mode["f_true_hz"].get<double>();
    square += std::pow(off / mode["f_sd_hz"].get<double>(), 2) / 11.0;
    EXPECT_LT(std::abs(off), 1e-4 * mode["f_true_hz"].get<double>());
    const double ratio = mode["zeta"].get<double>() - mode["zeta_true"].get<double>();
    of_ratios += std::pow(ratio / mode["zeta_sd"].get<double>(), 2) / 11.0;
  }
  // The mean of 11 squared standard normal numbers is 1 ± 0.43; four times that above. One in a
  // hundred lies below 0.28: deviations twice too large leave a quarter.
  for (const double mean : {square, of_ratios}) {
    EXPECT_LT(mean, 2.7);
    EXPECT_GT(mean, 0.28);
  }
  EXPECT_NEAR(document["stiff_string_law"]["f0_hz"].get<double>(), 196.0, 0.01);
  EXPECT_NEAR(document["stiff_string_law"]["B"].get<double>(), 1.54e-4, 2e-6);
}

TEST(IdentifyPluck, RefusesAStringAtRest) {
  YamlDocument document = read_yaml_file(kConfig);
  apply_assignment(document, "scene.initial=rest", 1);
  const LoadedExperiment loaded = load_experiment(std::move(document));
  EXPECT_THAT(format_mistakes(loaded.document, loaded.mistakes),
              testing::HasSubstr("has no free decay"));
}

}  // namespace
}  // namespace modcal::identify_test
