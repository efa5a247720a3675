// The force that a calibration of a recorded stroke identifies through the sensors it found.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/signal/statistics.hpp"
#include "tests/experiments/kinds/recorded_stroke.hpp"
#include "tests/refusal.hpp"

namespace modcal::calibrated_force_test {
namespace {

class CalibratedForce : public RecordedStroke {};

// Correlation and relative error of the identified forces.
std::vector<double> scores_of(const StudyResult& result) {
  std::vector<double> scores;
  for (const report::Block& block : result.blocks) {
    const auto* table = std::get_if<report::Table>(&block);
    if (!table || table->id != "identification") continue;
    for (std::size_t c = 0; c < table->columns.size(); ++c) {
      const std::string& key = table->columns[c].key;
      if (key != "correlation" && key != "relative_rms_error") continue;
      for (const auto& row : table->rows) scores.push_back(std::get<double>(row[c].value));
    }
  }
  return scores;
}

TEST_F(CalibratedForce, IdentifyTheForceThroughTheSensorsTheyFound) {
  // One sample is 20 us, so that the delay is exact.
  const Observation observed = stroke(simulated(0.4, 50000.0));
  const Signal& left = *observed.reaction(End::kLeft);
  const Signal& right = *observed.reaction(End::kRight);
  Signal sensed = right;
  for (std::size_t j = 0; j < sensed.size(); ++j) {
    sensed.samples[j] = 1.05 * right.samples[j > 0 ? j - 1 : 0];
  }
  const std::string sensors = ", sensors: [gain, delay]";
  for (const char* estimator : {"one_sided", "joint"}) {
    const std::string inversion = fmt::format("inversion: {{estimator: {}}}\n", estimator);
    write("stroke.csv", {left, right, *observed.reference});
    const StudyResult equal = run("", inversion, sensors);
    write("stroke.csv", {left, sensed, *observed.reference});
    const StudyResult different = run("", inversion, sensors);
    EXPECT_THAT(different.summary, testing::HasSubstr("corrected for its sensor"));
    const std::vector<double> expected = scores_of(equal);
    const std::vector<double> found = scores_of(different);
    ASSERT_GE(expected.size(), 2u);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      // Gain and delay are found to 1e-3 and 0.1 us; what is left of 5 % would be ten times this.
      EXPECT_NEAR(found[i], expected[i], 5e-3) << estimator << " " << i;
    }
  }
}

TEST_F(CalibratedForce, TakeTheDifferenceOfTheSensorsOutOnce) {
  // Both sensors read double, the one at x = L 5 % more and a sample later.
  const Observation observed = stroke(simulated(0.4, 50000.0));
  const Signal& left = *observed.reaction(End::kLeft);
  const Signal& right = *observed.reaction(End::kRight);
  Signal doubled = left, sensed = right;
  for (std::size_t j = 0; j < sensed.size(); ++j) {
    doubled.samples[j] = 2.0 * left.samples[j];
    sensed.samples[j] = 2.1 * right.samples[j > 0 ? j - 1 : 0];
  }
  const std::string sensors = ", sensors: [gain, delay]";
  write("stroke.csv", {left, right, *observed.reference});
  const std::vector<double> expected =
      scores_of(run("", "inversion: {estimator: joint}\n", sensors));
  ASSERT_EQ(expected.size(), 2u);
  write("stroke.csv", {doubled, sensed, *observed.reference});
  const std::vector<double> found =
      scores_of(run("", "inversion: {estimator: {type: joint, gain1: 2, gain2: 2}}\n", sensors));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(found[i], expected[i], 5e-3) << i;

  // What is in the calibration's correction has no place in the estimator: correlation 0.82 fell to
  // 0.80.
  const auto refusal = [&](const std::string& differing, const std::string& estimator) {
    const LoadedExperiment loaded = load_experiment(
        parse_yaml("kind: calibrate\n"
                   "record: {file: stroke.csv, left: {channel: R1}, right: {channel: R2}}\n"
                   "string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
                   "bow: {position: 30 mm}\n"
                   "calibration: {parameters: {frequencies: none" +
                       differing + "}}\ninversion: {estimator: " + estimator + "}\n",
                   (folder() / "experiment.yaml").string()));
    return format_mistakes(loaded.document, loaded.mistakes);
  };
  for (const char* estimator : {"{type: joint, gain2: 1.05}", "{type: joint, delay2: 20 us}",
                                "{type: linear_limit, gain1: 2, gain2: 2.1}"}) {
    for (const char* differing : {", sensors: [gain]", ", delay: 20 us", ""}) {
      EXPECT_THAT(refusal(differing, estimator), testing::HasSubstr("would take it out once more"))
          << estimator << differing;
    }
    // A calibration that knows of no difference.
    EXPECT_EQ(refusal(", sensors: [exact]", estimator), "");
  }
  EXPECT_EQ(refusal(", sensors: [gain]", "{type: joint, gain1: 2, gain2: 2}"), "");
}

// Identified over true force, by least squares about the means.
double scale_of(const StudyResult& result, const Signal& truth) {
  for (const Signal& found : result.signal_files.at(0).signals) {
    if (!found.quantity.starts_with("f_c")) continue;
    return correlation(found.samples, truth.samples) * standard_deviation(found.samples) /
           standard_deviation(truth.samples);
  }
  return 0.0;
}

TEST_F(CalibratedForce, IdentifyTheForceWithTheTensionThatTheyFound) {
  const Observation observed = stroke(simulated(0.4, 50000.0));
  write("stroke.csv",
        {*observed.reaction(End::kLeft), *observed.reaction(End::kRight), *observed.reference});
  const std::string inversion = "overview: false\n";
  const double expected = scale_of(run("", inversion), *observed.reference);
  EXPECT_GT(expected, 0.5);
  // The tension of 200 Hz would make the force 4 % smaller.
  const double found =
      scale_of(run("", inversion, ", sensors: [exact]", "200 Hz"), *observed.reference);
  EXPECT_NEAR(found / expected, 1.0, 1e-3);
}

}  // namespace
}  // namespace modcal::calibrated_force_test
