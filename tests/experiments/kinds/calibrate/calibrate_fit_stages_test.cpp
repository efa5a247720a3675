// What a calibration says of the stages of its search.

#include <gtest/gtest.h>

#include <algorithm>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/report/result.hpp"

namespace modcal::calibrate_fit_stages_test {
namespace {

std::vector<FitStage> stages() {
  return {{.name = "law, sigma = 200 1/s", .evaluations = 15, .objective = 900.0, .chi2 = 1.25},
          {.name = "free, weighted bins", .evaluations = 40, .objective = 700.0}};
}

CalibrationOutcome outcome_with_stages() {
  CalibrationOutcome outcome;
  ContinuationResult found;
  found.stages = stages();
  outcome.result.continuation = std::make_shared<ContinuationResult>(std::move(found));
  return outcome;
}

TEST(CalibrateStages, AreInTheFile) {
  const auto list = report::json_of(outcome_with_stages()).at("continuation").at("stages");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].at("name").get<std::string>(), "law, sigma = 200 1/s");
  EXPECT_EQ(list[0].at("evaluations").get<int>(), 15);
  EXPECT_EQ(list[0].at("objective").get<double>(), 900.0);
  EXPECT_EQ(list[0].at("chi2").get<double>(), 1.25);
  EXPECT_TRUE(list[1].at("chi2").is_null());
}

TEST(CalibrateStages, AreATableOfTheReport) {
  const auto is_of_stages = [](const report::Table& table) { return table.id == "stages"; };
  const std::vector<report::Table> without = report::tables_of(CalibrationOutcome());
  EXPECT_TRUE(std::none_of(without.begin(), without.end(), is_of_stages));
  const std::vector<report::Table> tables = report::tables_of(outcome_with_stages());
  const auto found = std::find_if(tables.begin(), tables.end(), is_of_stages);
  ASSERT_NE(found, tables.end());
  check_table(*found);
  ASSERT_EQ(found->rows.size(), 2u);
  EXPECT_EQ(std::get<double>(found->rows[0][3].value), 1.25);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(found->rows[1][3].value));
}

}  // namespace
}  // namespace modcal::calibrate_fit_stages_test
