// Every standard deviation that calibration.json prints is the one that was found.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/report/result.hpp"

namespace modcal::calibrate_deviations_test {
namespace {

// Numbers that are no multiples of each other by 2: one in the place of another shows.
ContinuationResult found() {
  ContinuationResult result;
  result.modes = {{.frequency = 196.0, .deviation = 3e-6, .data_deviation = 5e-6},
                  {.frequency = 392.0, .deviation = 7e-6, .data_deviation = 11e-6}};
  result.chi2_deviation = 0.0013;
  result.found_law = {196.0, 1e-4, {0.017, 0.019e-4}};
  result.contact_deviation = 0.023e-3;
  result.contact_deviations = {0.023e-3, 0.029e-3};
  result.damping_deviation = 0.031;
  result.model.sensors.smooth = {.knots = {{0.1, 0.2}, {0.3, 0.4}}, .spacing = 100.0};
  result.response_deviations = {{0.037, 0.041}, {0.043, 0.047}};
  result.priors = {.chi2 = 1.0, .count = 1, .farthest = "f0", .deviations = 1.7};
  result.law.priors = {.chi2 = 1.0, .count = 1, .farthest = "B", .deviations = 1.9};
  result.covariance = {.names = {"f_1", "f_2"}, .matrix = Eigen::Vector2d(9.0, 25.0).asDiagonal()};
  result.law.covariance = {.names = {"f0"}, .matrix = Eigen::MatrixXd::Constant(1, 1, 49.0)};
  return result;
}

CalibrationOutcome outcome() {
  CalibrationOutcome result;
  const ModalBasis basis{.length = 0.33,
                         .tension = 51.9,
                         .omega = {1231.5, 2463.0},
                         .zeta = {1e-3, 1e-3},
                         .mass = {5e-4, 5e-4}};
  result.initial = result.refined = {basis, 0.03};
  result.result.modes = {{.number = 1, .initial_frequency = 195.0, .frequency = 196.0},
                         {.number = 2, .initial_frequency = 390.0, .frequency = 392.0}};
  result.result.parameters = {
      {.name = "f_1", .unit = "Hz", .initial = 195.0, .final = 196.0, .deviation = 0.053},
      {.name = "x_c", .unit = "m", .initial = 0.03, .final = 0.03, .deviation = 0.059e-3}};
  result.result.continuation = std::make_shared<ContinuationResult>(found());
  return result;
}

TEST(CalibrateDeviations, OfParametersAndModesAreInTheFile) {
  const report::Json document = report::json_of(outcome());
  const auto& parameters = document.at("parameters");
  EXPECT_EQ(parameters.at(0).at("sd").get<double>(), 0.053);
  EXPECT_EQ(parameters.at(1).at("sd").get<double>(), 0.059e-3);
  const auto& modes = document.at("modes");
  EXPECT_EQ(modes.at(0).at("relative_sd").get<double>(), 3e-6);
  EXPECT_EQ(modes.at(0).at("data_sd").get<double>(), 5e-6);
  EXPECT_EQ(modes.at(1).at("relative_sd").get<double>(), 7e-6);
  EXPECT_EQ(modes.at(1).at("data_sd").get<double>(), 11e-6);
}

TEST(CalibrateDeviations, OfTheWholeFitAreInTheFile) {
  const report::Json document = report::json_of(outcome()).at("continuation");
  const std::pair<const char*, double> expected[] = {{"chi2_sd", 0.0013},
                                                     {"f0_sd_hz", 0.017},
                                                     {"B_sd", 0.019e-4},
                                                     {"x_c_sd_m", 0.023e-3},
                                                     {"damping_sd", 0.031}};
  for (const auto& [key, value] : expected) EXPECT_EQ(document.at(key).get<double>(), value) << key;
  EXPECT_EQ(document.at("x_c_sd_of_strokes_m").get<std::vector<double>>(),
            (std::vector<double>{0.023e-3, 0.029e-3}));
  EXPECT_EQ(document.at("priors").at("deviations").get<double>(), 1.7);
  EXPECT_EQ(document.at("law_priors").at("deviations").get<double>(), 1.9);
  EXPECT_EQ(document.at("covariance").at("sd").get<std::vector<double>>(),
            (std::vector<double>{3.0, 5.0}));
  EXPECT_EQ(document.at("law_covariance").at("sd").get<std::vector<double>>(),
            (std::vector<double>{7.0}));
  const auto& response = document.at("sensor_response");
  ASSERT_EQ(response.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::complex<double> deviation = found().response_deviations[k];
    EXPECT_EQ(response.at(k).at("log_gain_sd").get<double>(), deviation.real());
    EXPECT_EQ(response.at(k).at("phase_sd_rad").get<double>(), deviation.imag());
  }
}

}  // namespace
}  // namespace modcal::calibrate_deviations_test
