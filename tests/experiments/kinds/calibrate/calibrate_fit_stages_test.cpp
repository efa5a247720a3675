// What a calibration says of the stages of its continuation.
#include "experiments/kinds/calibrate/calibrate_fit_stages.hpp"

#include <gtest/gtest.h>

#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "experiments/study/study.hpp"

namespace modcal {
namespace {

std::vector<FitStage> stages() {
  return {{.name = "law, sigma = 200 1/s", .evaluations = 15, .objective = 900.0, .chi2 = 1.25},
          {.name = "free, weighted bins", .evaluations = 40, .objective = 700.0}};
}

TEST(CalibrateStages, AreInTheFile) {
  const auto list = stages_json(stages());
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].at("name").get<std::string>(), "law, sigma = 200 1/s");
  EXPECT_EQ(list[0].at("evaluations").get<int>(), 15);
  EXPECT_EQ(list[0].at("objective").get<double>(), 900.0);
  EXPECT_EQ(list[0].at("chi2").get<double>(), 1.25);
  EXPECT_TRUE(list[1].at("chi2").is_null());
}

TEST(CalibrateStages, AreATableOfTheReport) {
  CalibrationOutcome outcome;
  StudyResult result;
  add_stages(outcome, "test", result);
  EXPECT_TRUE(result.blocks.empty());
  outcome.result.continuation.emplace().stages = stages();
  add_stages(outcome, "test", result);
  ASSERT_EQ(result.blocks.size(), 1u);
  const auto& table = std::get<report::Table>(result.blocks[0]);
  check_table(table);
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(std::get<double>(table.rows[0][3].value), 1.25);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(table.rows[1][3].value));
}

}  // namespace
}  // namespace modcal
