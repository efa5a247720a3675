// Calibrations of recorded strokes and plucks, and what follows from the sensors they find.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/loader.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/folder_test.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::calibrate_records_test {
namespace {

using nlohmann::json;

class CalibrateRecords : public FolderTest {
 protected:
  StudyContext context() { return {.work = work_, .folder = folder(), .command = "test"}; }

  // The law of the paper's string from a stroke with 1 % noise.
  static CalibrateOptions simulated(double duration, double sample_rate) {
    CalibrateOptions options;
    ObservationOptions& observation = options.inversion.observation;
    observation.has_scene = true;
    observation.truth.scene = paper_scene();
    observation.truth.scene.duration = duration;
    observation.truth.simulator.select("modal_event");
    observation.measurement.sample_rate = sample_rate;
    observation.measurement.noise_level = 0.01;
    options.calibration = calibration_to_the_bound();
    options.calibration.parameters.frequencies = "none";
    return options;
  }

  Observation stroke(const CalibrateOptions& options) {
    return observe(options.inversion.observation, {.force = true}, work_.truths,
                   options.inversion.key(), folder());
  }

  void write(const std::string& file, const std::vector<Signal>& signals) {
    write_csv(folder() / file, signals);
  }

  // What was recorded is a simulation of exactly the stated modes.
  StudyResult run(const std::string& noise, const std::string& further,
                  const std::string& sensors = ", sensors: [exact]",
                  const std::string& fundamental = "196 Hz") {
    const LoadedExperiment loaded = load_experiment(
        parse_yaml("kind: calibrate\n"
                   "record: {file: stroke.csv, left: {channel: R1}, right: {channel: R2}, "
                   "reference: {channel: f_c}}\n"
                   "string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: " +
                       fundamental +
                       ", modes: 50}\n"
                       "bow: {position: 30 mm}\n"
                       "calibration: {parameters: {frequencies: none, damping: factor" +
                       sensors + "}, objective: {type: joint_likelihood" + noise +
                       "}, remainder: none}\n" + further,
                   (folder() / "experiment.yaml").string()));
    EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
    return loaded.experiment ? loaded.experiment->run(context()) : StudyResult();
  }
  SharedWork work_;
};

json calibration_of(const StudyResult& result) {
  for (const auto& [name, content] : result.files) {
    if (name == "calibration.json") return json::parse(content);
  }
  return {};
}

TEST_F(CalibrateRecords, FindFromARecordedPluckWhatASimulatedOneTells) {
  CalibrateOptions options = simulated(0.3, 51200.0);
  PluckRecordOptions pluck;
  pluck.start = Choice<InitialMotion>::of<Pluck>(
      "pluck", {.position = 0.043, .displacement = 1e-3, .width = 3e-3});
  pluck.duration = 0.3;
  options.plucks = {pluck};
  const json direct = calibration_of(options.run(context()));

  const Observation observed = stroke(options);
  write("stroke.csv",
        {*observed.reaction(End::kLeft), *observed.reaction(End::kRight), *observed.reference});
  const CalibrationRecord decay = observe_plucks(options.plucks, options.inversion.observation,
                                                 options.inversion.key(), context())[0];
  const RealFft fft(decay.data.samples);
  std::vector<Signal> signals;
  for (const End end : kEnds) {
    signals.push_back({.quantity = end == End::kLeft ? "R1" : "R2",
                       .unit = "N",
                       .sample_rate = decay.data.sample_rate,
                       .samples = fft.inverse(decay.data.reaction(end))});
  }
  signals.push_back(*observed.reference);
  write("pluck.csv", signals);
  const json recorded = calibration_of(run("", "plucks: [{record: pluck.csv}]\n"));

  ASSERT_EQ(recorded["parameters"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const double expected = direct["parameters"][i]["final"];
    // The record starts from the string that it tells: what the search converges to is the same to
    // its tolerance, 1e-4 of minus the log likelihood or 0.014 deviations.
    EXPECT_NEAR(recorded["parameters"][i]["final"].get<double>(), expected,
                0.014 * direct["parameters"][i]["sd"].get<double>())
        << i;
  }
  EXPECT_TRUE(recorded["continuation"]["right"].get<bool>());
  EXPECT_NEAR(recorded["continuation"]["chi2"], direct["continuation"]["chi2"].get<double>(),
              0.014 * direct["continuation"]["chi2_sd"].get<double>());
}

TEST_F(CalibrateRecords, FailByThePriorsWhereTheFitIsNotWrong) {
  // x_c is known to half a micrometer; this prior, ten deviations off, moves it by a fortieth of
  // one.
  CalibrateOptions options = simulated(0.3, 51200.0);
  options.calibration.parameters.unknowns.priors = {
      {.parameter = "x_c", .mean = 30.1e-3, .deviation = 1e-5}};
  const StudyResult result = options.run(context());
  EXPECT_TRUE(calibration_of(result)["continuation"]["fits"].get<bool>());
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.summary, testing::HasSubstr("warning: the data contradict the priors stated"));
  EXPECT_THAT(result.summary, testing::Not(testing::HasSubstr("search failed")));
  EXPECT_THAT(result.summary, testing::Not(testing::HasSubstr("FIT IS WRONG")));
}

TEST_F(CalibrateRecords, SayWhereTheNoiseStatedIsTooMuch) {
  const Observation observed = stroke(simulated(0.3, 51200.0));
  write("stroke.csv",
        {*observed.reaction(End::kLeft), *observed.reaction(End::kRight), *observed.reference});
  const double spread[] = {standard_deviation(observed.reaction(End::kLeft)->samples),
                           standard_deviation(observed.reaction(End::kRight)->samples)};
  const StudyResult overstated = run(
      fmt::format(", noise_rms_1: {:g} N, noise_rms_2: {:g} N", 0.03 * spread[0], 0.03 * spread[1]),
      "");
  // Three times the noise there is: within the 2 % to which 0.3 s tell it, three of them.
  const double chi2 = calibration_of(overstated)["continuation"]["chi2"];
  EXPECT_NEAR(9.0 * chi2, 1.0, 0.1);
  EXPECT_THAT(overstated.summary,
              testing::HasSubstr(fmt::format(
                  "noise overstated: the data scatter less than the noise levels say; standard "
                  "deviations are too wide by a factor of {:.3g}",
                  1.0 / std::sqrt(chi2))));
  EXPECT_THAT(run("", "").summary, testing::Not(testing::HasSubstr("overstated")));
}

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

TEST_F(CalibrateRecords, IdentifyTheForceThroughTheSensorsTheyFound) {
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

TEST_F(CalibrateRecords, TakeTheDifferenceOfTheSensorsOutOnce) {
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

TEST_F(CalibrateRecords, IdentifyTheForceWithTheTensionThatTheyFound) {
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
}  // namespace modcal::calibrate_records_test
