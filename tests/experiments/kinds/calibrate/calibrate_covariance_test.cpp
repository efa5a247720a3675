// What a calibration says of the covariance it found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/report/result.hpp"

namespace modcal::calibrate_covariance_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Two modes, the second where the law has it; r = -0.5 between f_1 and x_c, 0.9 of the law's.
ContinuationResult found() {
  ContinuationResult result;
  result.frequencies_free = true;
  result.modes = {{.frequency = 196.0, .source = ModeSource::kIdentified},
                  {.frequency = 392.0, .source = ModeSource::kLaw}};
  result.covariance.names = {"f_1", "f_2", "x_c"};
  result.covariance.matrix =
      Eigen::Matrix3d{{4e-6, 3e-6, -1e-9}, {3e-6, 4e-6, -0.2e-9}, {-1e-9, -0.2e-9, 1e-12}};
  result.law.accepted = true;
  result.law.covariance.names = {"f0", "x_c", "damping"};
  result.law.covariance.matrix =
      Eigen::Matrix3d{{1e-6, 0.9e-9, 0.0}, {0.9e-9, 1e-12, 0.0}, {0.0, 0.0, 4e-6}};
  return result;
}

// The outcome of a calibration whose modes have not been asked for.
CalibrationOutcome outcome_of(ContinuationResult continuation) {
  CalibrationOutcome outcome;
  outcome.result.continuation = std::make_shared<ContinuationResult>(std::move(continuation));
  return outcome;
}

report::Json covariance_json(const NamedCovariance& covariance) {
  ContinuationResult result;
  result.covariance = covariance;
  return report::json_of(outcome_of(std::move(result))).at("continuation").at("covariance");
}

TEST(CorrelationText, HasALineForEveryParameterWithUnitAndCorrelations) {
  EXPECT_EQ(correlation_lines(found().law.covariance),
            "  f0       sd 0.001     Hz        correlations\n"
            "  x_c      sd 1e-06     m         correlations f0 +0.90\n"
            "  damping  sd 0.002     (factor)  correlations f0 +0.00 x_c +0.00\n");
}

TEST(CalibrateCovariance, SaysWhatIsCorrelatedMostOfWhatTheDataTell) {
  const std::string text = covariance_text(found());
  EXPECT_THAT(text, HasSubstr("stiff-string law, fitted alone:\n  f0 "));
  EXPECT_THAT(text, HasSubstr("strongest correlations: x_c with f_1 -0.50\n"));
  EXPECT_THAT(text, Not(HasSubstr("f_2")));  // the law holds it
  // Eigenvalues of R of the law are 1.9, 1 and 0.1.
  EXPECT_THAT(text, HasSubstr("singular values in standard deviations 3.16 to 0.725, condition "
                              "4.36\n"));
  ContinuationResult law_alone = found();
  law_alone.frequencies_free = false;
  EXPECT_THAT(covariance_text(law_alone), Not(HasSubstr("every frequency")));
  EXPECT_THAT(covariance_text(law_alone), HasSubstr("stiff-string law:\n  f0 "));
}

TEST(CalibrateCovariance, TellsNothingOfALawThatTheDataReject) {
  ContinuationResult rejected = found();
  rejected.law.accepted = false;
  EXPECT_THAT(covariance_text(rejected), Not(HasSubstr("stiff-string law")));
  EXPECT_THAT(covariance_text(rejected), HasSubstr("every frequency free"));
}

TEST(CalibrateCovariance, HasEveryCorrelationInItsFile) {
  const auto document = covariance_json(found().covariance);
  EXPECT_EQ(document.at("names").dump(), R"(["f_1","f_2","x_c"])");
  EXPECT_EQ(document.at("units").dump(), R"(["Hz","Hz","m"])");
  EXPECT_EQ(document.at("sd").at(1).get<double>(), 2e-3);
  const auto& rows = document.at("correlations");
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(rows[i].size(), 3u);
    EXPECT_EQ(rows[i][i].get<double>(), 1.0);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(rows[i][j], rows[j][i]);
  }
  EXPECT_NEAR(rows[2][0].get<double>(), -0.5, 1e-12);
  EXPECT_EQ(document.at("singular_values").size(), 3u);
  EXPECT_NEAR(document.at("condition").get<double>(), found().covariance.condition(), 1e-12);
}

TEST(CalibrateCovariance, WhatIsNotFiniteIsNull) {
  NamedCovariance tied{.names = {"f_1", "f_2"}, .matrix = Eigen::Matrix2d{{1.0, 2.0}, {2.0, 1.0}}};
  EXPECT_TRUE(covariance_json(tied).at("condition").is_null());
}

std::vector<std::string> names_in(const report::Table& map) {
  std::vector<std::string> names;
  for (const auto& row : map.rows) names.push_back(std::get<std::string>(row[0].value));
  return names;
}

TEST(CalibrateCovariance, IsAMapOfTheLaw) {
  const report::Table map = correlation_map(found());
  check_table(map);
  EXPECT_THAT(names_in(map), ElementsAre("f0", "x_c", "damping"));
  ASSERT_EQ(map.columns.size(), 4u);
  EXPECT_EQ(map.columns[2].key, "x_c");
  EXPECT_NEAR(std::get<double>(map.rows[0][2].value), 0.9, 1e-12);
  EXPECT_NEAR(map.rows[1][1].heat, 0.9, 1e-12);
  EXPECT_EQ(report::cell_text(map.rows[1][2], map.columns[2]), "–");
}

TEST(CalibrateCovariance, IsAMapOfWhatIsBoundMostWhereTheDataRejectTheLaw) {
  ContinuationResult rejected = found();
  rejected.law.accepted = false;
  const report::Table map = correlation_map(rejected);
  EXPECT_THAT(names_in(map), ElementsAre("f_1", "x_c"));  // the law holds f_2
  EXPECT_NEAR(std::get<double>(map.rows[0][2].value), -0.5, 1e-12);
  EXPECT_NEAR(map.rows[0][2].heat, 0.5, 1e-12);
}

TEST(CalibrateCovariance, TellsNothingOfALawThatThePriorsContradict) {
  ContinuationResult rejected = found();
  rejected.law.priors = {.chi2 = 400.0, .count = 120, .farthest = "the response at 1980 Hz"};
  EXPECT_THAT(covariance_text(rejected), Not(HasSubstr("stiff-string law")));
  EXPECT_THAT(chi2_text(rejected), HasSubstr("contradict the priors"));
  EXPECT_THAT(chi2_text(found()), HasSubstr("all modes follow it"));
}

}  // namespace
}  // namespace modcal::calibrate_covariance_test
