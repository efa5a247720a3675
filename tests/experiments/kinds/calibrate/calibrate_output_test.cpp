// What a calibration says of its parameters and priors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/report/result.hpp"

namespace modcal::calibrate_output_test {
namespace {

using testing::HasSubstr;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

PriorMisfit far_off() {
  return {.chi2 = 136900.0, .count = 2, .farthest = "x_c", .deviations = 370.0};
}

CalibrationOutcome outcome_of(const PriorMisfit& priors) {
  CalibrationOutcome outcome;
  const ModalBasis basis{
      .length = 0.33, .tension = 51.9, .omega = {1231.5}, .zeta = {1e-3}, .mass = {5e-4}};
  outcome.initial = outcome.refined = {basis, 0.03};
  outcome.result.modes = {{.number = 1, .initial_frequency = 195.0, .frequency = 196.0}};
  outcome.result.parameters = {
      {.name = "damping_power", .unit = "1", .initial = 0.0, .final = 0.05, .deviation = 2e-3},
      {.name = "delay", .unit = "s", .initial = 0.0, .final = 1e-6, .deviation = kNone}};
  ContinuationResult found;
  found.modes = {{.frequency = 196.0, .deviation = 2e-6}};
  found.fits = true;
  found.priors = priors;
  found.right = !priors.contradicted();
  outcome.result.continuation = std::make_shared<ContinuationResult>(found);
  return outcome;
}

TEST(CalibrateOutput, SaysThatThePriorsAreContradicted) {
  const std::string text = prior_lines(far_off(), "law");
  EXPECT_THAT(text, HasSubstr("law: prior chi2 1.369e+05 of 2"));
  EXPECT_THAT(text, HasSubstr("THE PRIORS ARE CONTRADICTED BY THE DATA"));
  EXPECT_THAT(text, HasSubstr("farthest: x_c by 370 deviations"));
  EXPECT_THAT(prior_lines({.chi2 = 1.0, .count = 1, .farthest = "f0", .deviations = 1.0}, "law"),
              HasSubstr("do not contradict the priors"));
  EXPECT_EQ(prior_lines({}, "law"), "");
}

TEST(CalibrateOutput, HasThePriorsMisfitAndTheDeviationsInItsFile) {
  const report::Json document = report::json_of(outcome_of(far_off()));
  const auto& continuation = document.at("continuation");
  EXPECT_FALSE(continuation.at("right").get<bool>());
  EXPECT_TRUE(continuation.at("fits").get<bool>());
  EXPECT_EQ(continuation.at("priors").at("chi2").get<double>(), 136900.0);
  EXPECT_EQ(continuation.at("priors").at("count").get<int>(), 2);
  EXPECT_TRUE(continuation.at("priors").at("contradicted").get<bool>());
  EXPECT_EQ(continuation.at("priors").at("farthest").get<std::string>(), "x_c");
  const auto& parameters = document.at("parameters");
  EXPECT_EQ(parameters.at(0).at("sd").get<double>(), 2e-3);
  EXPECT_THAT(parameters.at(0).at("meaning").get<std::string>(), HasSubstr("exponent p"));
  EXPECT_TRUE(parameters.at(1).at("sd").is_null());
}

TEST(CalibrateOutput, TablesHaveDeviationsWhereTheyAreKnown) {
  const CalibrationOutcome outcome = outcome_of({});
  const std::vector<report::Table> tables = report::tables_of(outcome);
  const auto table_called = [&tables](std::string_view id) {
    return *std::find_if(tables.begin(), tables.end(),
                         [id](const report::Table& table) { return table.id == id; });
  };
  const report::Table parameters = report::tables_of([&outcome](ResultVisitor& visitor) {
                                     outcome.visit_parameters(visitor);
                                   }).at(0);
  ASSERT_EQ(parameters.rows.size(), 2u);
  const report::Table modes = table_called("modes");
  ASSERT_EQ(modes.rows.size(), 1u);
  for (const report::Table& table : {parameters, modes}) {
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  }
  EXPECT_EQ(std::get<double>(parameters.rows[0][3].value), 2e-3);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(parameters.rows[1][3].value));
  EXPECT_EQ(std::get<double>(modes.rows[0][5].value), 2e-6);
  EXPECT_EQ(std::get<std::string>(modes.rows[0][7].value), "identified");
  EXPECT_EQ(verdict_text({.source = ModeSource::kLaw, .reason = WeakReason::kNode}),
            "from the law (node)");
}

TEST(CalibrateOutput, ShowsLengthsInMillimetersAndTwoDigitsOfTheDeviation) {
  CalibrationOutcome outcome = outcome_of({});
  outcome.result.parameters = {
      {.name = "x_c", .unit = "m", .initial = 0.029, .final = 0.030000214, .deviation = 5.84e-6},
      {.name = "B", .unit = "1", .initial = 0.0, .final = 2.98765e-9, .deviation = 4e-11},
      {.name = "gain", .unit = "1", .initial = 1.0, .final = 1.00012345, .deviation = kNone}};
  const report::Table table = parameter_tables(outcome).at(0);
  const auto shown = [&table](std::size_t i, std::size_t j) {
    return report::cell_text(table.rows[i][j], table.columns[j]);
  };
  EXPECT_EQ(shown(0, 1), "29.0000");
  EXPECT_EQ(shown(0, 2), "30.0002");
  EXPECT_EQ(shown(0, 3), "0.0058");
  EXPECT_EQ(shown(0, 4), "mm");
  EXPECT_EQ(shown(1, 2), "2.988e-09");
  EXPECT_EQ(shown(2, 2), "1.00012");
  EXPECT_EQ(shown(2, 3), "–");
  EXPECT_THAT(report::table_csv(table), HasSubstr("x_c,0.029,0.030000214,5.84e-06,m,"));
}

// Beyond the band nothing is left over to judge by: that is no failure.
TEST(CalibrateOutput, LeavesTheChi2OfAModeBeyondTheBandEmpty) {
  CalibrationOutcome outcome = outcome_of({});
  auto found = std::make_shared<ContinuationResult>(*outcome.result.continuation);
  found->local.modes = {{.chi2 = kNone}};
  outcome.result.continuation = found;
  for (const report::Table& table : report::tables_of(outcome)) {
    for (std::size_t j = 0; j < table.columns.size(); ++j) {
      if (table.columns[j].name != "chi2 about it") continue;
      EXPECT_EQ(report::cell_text(table.rows.at(0)[j], table.columns[j]), "–");
      return;
    }
  }
  ADD_FAILURE() << "no such column";
}

TEST(CalibrateOutput, SaysWhichModesLeaveTheLawAndWhichAreDrawnToIt) {
  EXPECT_EQ(
      verdict_text(
          {.deviation = 6e-4, .data_deviation = 6e-4, .tie = LawTie::kLeaves, .departure = 4e-3}),
      "identified, leaves the law by +0.4 %");
  EXPECT_EQ(verdict_text({.deviation = 1e-5, .data_deviation = 6e-4}),
            "identified, drawn to the law");
  EXPECT_EQ(
      verdict_text(
          {.source = ModeSource::kLaw, .reason = WeakReason::kDoubt, .tie = LawTie::kDoubtful}),
      "from the law (data and law disagree)");
}

}  // namespace
}  // namespace modcal::calibrate_output_test
