// A simulated record written to a file and inverted from it gives what inverting the simulation
// gives.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "experiments/kinds/invert/invert.hpp"
#include "experiments/kinds/simulate/simulate_study.hpp"
#include "experiments/loader.hpp"
#include "experiments/records/inspection.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/folder_test.hpp"

namespace modcal::record_round_trip_test {
namespace {

class RecordRoundTrip : public FolderTest {
 protected:
  LoadedExperiment load(const std::string& yaml) const {
    LoadedExperiment loaded =
        load_experiment(parse_yaml(yaml, (folder() / "experiment.yaml").string()));
    EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
    return loaded;
  }
  StudyResult run(const std::string& yaml) {
    const LoadedExperiment loaded = load(yaml);
    if (!loaded.experiment) return {};
    return loaded.experiment->run({.work = work_, .folder = folder(), .command = "test"});
  }
  void write_record() {
    const StudyResult simulated = run(kScene + R"(
kind: simulate
measurement: {sample_rate: 51.2 kHz, noise_level: 1 %, remove_mean: true}
outputs: [y, v, f_c, R1, R2]
files: [csv, wav]
seed: 3
)");
    ASSERT_EQ(simulated.signal_files.size(), 2u);
    write_csv(folder() / "signals.csv", simulated.signal_files[0].signals);
    write_wav(folder() / "signals.wav", simulated.signal_files[1].signals,
              {.samples = WavSamples::kDouble, .full_scale = 1.0});
  }
  static std::string record(const std::string& file) {
    return R"(
kind: invert
record: {file: )" +
           file + R"(, left: {channel: R1}, right: {channel: R2}, reference: {channel: f_c}}
string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 50}
bow: {position: 30 mm}
inversion: {estimator: one_sided}
)";
  }

  const std::string kScene = R"(
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 50}
  bow: {position: 30 mm}
  duration: 0.42 s
simulator: modal_exact
)";
  SharedWork work_;
};

TEST_F(RecordRoundTrip, CsvAndSoundFileGiveTheBitsOfTheSimulation) {
  write_record();
  const StudyResult direct = run(kScene + R"(
kind: invert
measurement: {sample_rate: 51.2 kHz, noise_level: 1 %, remove_mean: true}
inversion: {estimator: one_sided}
seed: 3
)");
  ASSERT_EQ(direct.signal_files.size(), 1u);
  for (const char* file : {"signals.csv", "signals.wav"}) {
    const StudyResult from_file = run(record(file));
    ASSERT_EQ(from_file.signal_files.size(), 1u) << file;
    const auto& expected = direct.signal_files[0].signals;
    const auto& actual = from_file.signal_files[0].signals;
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(actual[i].size(), expected[i].size());
      double scale = 0.0, difference = 0.0;
      for (std::size_t k = 0; k < expected[i].size(); ++k) {
        scale = std::max(scale, std::abs(expected[i].samples[k]));
        difference = std::max(difference, std::abs(actual[i].samples[k] - expected[i].samples[k]));
      }
      // The record's mean is removed twice, which moves samples by their rounding.
      EXPECT_LE(difference, 1e-9 * scale) << expected[i].quantity;
    }
    EXPECT_NE(from_file.summary.find("R = "), std::string::npos);  // scored by the reference
  }
}

TEST_F(RecordRoundTrip, MeasuredMotionIsDrawnAndScored) {
  write_record();
  std::string yaml = record("signals.csv");
  const std::string force = "reference: {channel: f_c}";
  yaml.replace(yaml.find(force), force.size(),
               "reference_velocity: {channel: v}, reference_displacement: {channel: y}");
  const StudyResult result = run(yaml);
  EXPECT_NE(result.summary.find("v at the contact"), std::string::npos) << result.summary;
  const report::Table* motion = nullptr;
  std::size_t measured = 0;
  for (const report::Block& block : result.blocks) {
    const auto* table = std::get_if<report::Table>(&block);
    if (table != nullptr && table->id == "motion") motion = table;
    const auto* figure = std::get_if<report::Figure>(&block);
    if (figure == nullptr || figure->id != "identified_motion") continue;
    for (const report::Panel& panel : figure->panels) {
      for (const report::Series& series : panel.series) measured += series.label == "measured";
    }
  }
  EXPECT_EQ(measured, 4u);  // y and v of both sides
  ASSERT_NE(motion, nullptr);
  ASSERT_EQ(motion->rows.size(), 4u);
  EXPECT_NE(result.summary.find("v at the contact  0.01"), std::string::npos) << result.summary;
  // A window that holds nothing of the record is told by validate.
  LoadedExperiment loaded = load_experiment(
      parse_yaml(yaml + "score: {windows: [9 s]}\n", (folder() / "e.yaml").string()));
  check_records(loaded);
  EXPECT_TRUE(loaded.has_errors());
}

TEST_F(RecordRoundTrip, ACalibrationRunsOnARecord) {
  write_record();
  std::string yaml = record("signals.csv");
  yaml.replace(yaml.find("invert"), 6, "calibrate");
  const StudyResult result = run(yaml + R"(
model_error: {frequencies: 1 %}
calibration: {parameters: {law: false, contact: false}, objective: spectral_peak, optimizer: {type: mode_by_mode, loops: 2}}
)");
  ASSERT_FALSE(result.files.empty());
  EXPECT_EQ(result.files[0].first, "calibration.json");
  const auto document = nlohmann::json::parse(result.files[0].second);
  ASSERT_EQ(document["modes"].size(), 50u);
  std::vector<double> errors, initial;
  for (const auto& mode : document["modes"]) {
    EXPECT_TRUE(mode["f_true_hz"].is_null());  // a record does not tell
    if (!mode["excited"].get<bool>()) continue;
    const double truth = 196.0 * mode["n"].get<double>();
    errors.push_back(std::abs(mode["f_hz"].get<double>() / truth - 1.0));
    initial.push_back(std::abs(mode["f_initial_hz"].get<double>() / truth - 1.0));
  }
  // Two loops of candidates that lie 0.12 % apart, where the start is uniform within 1 %.
  ASSERT_GT(errors.size(), 30u);
  EXPECT_NEAR(quantile(initial, 0.5), 5e-3, 2e-3);
  EXPECT_LT(quantile(errors, 0.5), 1.2e-3);
}

TEST_F(RecordRoundTrip, ACalibrationFindsTheStringOfARecord) {
  write_record();
  std::string yaml = record("signals.csv");
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"invert", "calibrate"},
                                 {"196 Hz", "197.5 Hz"},
                                 {"30 mm", "30.6 mm"},
                                 {"inversion: {estimator: one_sided}", ""}}) {
    yaml.replace(yaml.find(from), from.size(), to);
  }
  const StudyResult result =
      run(yaml + "calibration: {remainder: none, parameters: {frequencies: none}}\n");
  EXPECT_EQ(result.status, report::Status::kOk) << result.summary;
  ASSERT_FALSE(result.files.empty());
  const auto document = nlohmann::json::parse(result.files[0].second);
  std::map<std::string, double> truth = {{"f0", 196.0}, {"B", 0.0}, {"x_c", 0.03}};
  for (const auto& parameter : document["parameters"]) {
    const auto known = truth.find(parameter["name"].get<std::string>());
    if (known == truth.end()) continue;
    const double sd = parameter["sd"].get<double>();
    EXPECT_LT(std::abs(parameter["final"].get<double>() - known->second), 2.5 * sd) << known->first;
    EXPECT_GT(sd, 0.0);
    EXPECT_LT(sd, known->first == "B" ? 1e-6 : 1e-3 * known->second) << known->first;
    truth.erase(known);
  }
  EXPECT_TRUE(truth.empty());
}

TEST_F(RecordRoundTrip, TheInspectedStanzaAsksForTheStringAndNothingElse) {
  write_record();
  const InspectionReport report = inspect(folder() / "signals.csv");
  LoadedExperiment loaded =
      load_experiment(parse_yaml(stanza(report), (folder() / "mine.yaml").string()));
  EXPECT_TRUE(loaded.has_errors());
  for (const Mistake& mistake : loaded.mistakes) {
    EXPECT_NE(mistake.text.find("there is no value"), std::string::npos) << mistake.text;
  }
  EXPECT_EQ(loaded.kind, "invert");
}

}  // namespace
}  // namespace modcal::record_round_trip_test
