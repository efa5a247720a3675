// Kind "identify" on free decays of a structure, as sums of damped sinusoids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"
#include "libsim/base/random.hpp"
#include "tests/experiments/kinds/run_document.hpp"
#include "tests/folder_test.hpp"

namespace modcal::identify_structure_test {
namespace {

using testing::HasSubstr;

struct Mode {
  double frequency, ratio;
  double amplitudes[3];
};
// No multiples of one frequency, two of them 2 % apart.
constexpr Mode kModes[] = {{31.4, 0.012, {1.0, 0.6, -0.3}},
                           {77.0, 0.008, {0.7, -0.8, 0.5}},
                           {118.6, 0.006, {-0.4, 0.5, 0.9}},
                           {121.0, 0.007, {0.6, 0.3, -0.5}},
                           {203.3, 0.004, {0.3, 0.4, 0.4}}};
constexpr double kRate = 2000.0, kReleased = 0.25;

class DecayingStructureTest : public FolderTest {
 protected:
  // Bent to one side, then let go; two accelerations in g and a displacement in mm.
  void write_decay(double noise) const {
    std::string text = "t [s],a1 [g],a2 [g],d [mm]\n";
    const auto count = static_cast<std::size_t>(4.0 * kRate);
    std::vector<double> normal(3 * count);
    fill_standard_normal(StreamKey(4).with("noise"), normal);
    for (std::size_t j = 0; j < count; ++j) {
      const double t = static_cast<double>(j) / kRate - kReleased;
      text += fmt::format("{:.6f}", t + kReleased);
      for (std::size_t k = 0; k < 3; ++k) {
        double sum = noise * normal[3 * j + k];
        for (const auto& [frequency, ratio, amplitudes] : kModes) {
          if (t < 0.0) continue;
          const double omega = 2.0 * std::numbers::pi * frequency;
          sum += amplitudes[k] * std::exp(-ratio * omega * t) *
                 std::cos(omega * std::sqrt(1.0 - ratio * ratio) * t);
        }
        text += fmt::format(",{:.9g}", sum);
      }
      text += "\n";
    }
    write("decay.csv", text);
  }
  YamlDocument document(const std::string& keys) const {
    write("identify.yaml",
          "kind: identify\nstructure:\n  record:\n    file: decay.csv\n    responses: [{channel: "
          "a1}, "
          "{channel: a2}, {channel: d, kind: displacement}]\n" +
              keys);
    return read_yaml_file(path("identify.yaml"));
  }
  static constexpr const char* kBand =
      "identification: {lowest_frequency: 20 Hz, highest_frequency: 300 Hz}\n";
};

// The mean square of ten numbers over their deviations is 1 ± .45; two poles 2 % apart are two
// modes.
TEST_F(DecayingStructureTest, HasModesInOrderWithErrorBarsAndShapes) {
  write_decay(0.02);
  const StudyResult result = run_document(document(kBand));
  EXPECT_EQ(result.status, report::Status::kOk) << result.answer;
  const auto found = nlohmann::json::parse(result.files.at(0).second);
  ASSERT_EQ(found["modes"].size(), 5u) << found.dump(1);
  double squares = 0.0;
  for (std::size_t n = 0; n < 5; ++n) {
    const auto& mode = found["modes"][n];
    EXPECT_EQ(mode["n"], n + 1);
    squares += std::pow(
        (mode["f_hz"].get<double>() - kModes[n].frequency) / mode["f_sd_hz"].get<double>(), 2);
    squares +=
        std::pow((mode["zeta"].get<double>() - kModes[n].ratio) / mode["zeta_sd"].get<double>(), 2);
  }
  EXPECT_LT(squares / 10.0, 2.4);
  EXPECT_GT(squares / 10.0, 0.2);
  EXPECT_FALSE(found.contains("stiff_string_law"));
  // Of a mode by itself: .02 of noise over some hundred samples.
  ASSERT_EQ(found["shapes"].size(), 15u);
  const auto size_of = [&](std::size_t i) { return found["shapes"][i]["amplitude"].get<double>(); };
  EXPECT_EQ(found["shapes"][1]["channel"], "a2");
  EXPECT_NEAR(size_of(1) / size_of(0), 0.6, 0.03);
  // An acceleration of 1 g beside a displacement of 1 mm.
  EXPECT_NEAR(size_of(2) / size_of(0), 0.3 * 1e-3 / 9.80665, 0.05 * 0.3 * 1e-3 / 9.80665);
}

// At a node of all modes.
TEST_F(DecayingStructureTest, ASensorThatHearsNothingIsNamed) {
  write_decay(0.02);
  std::string text = content_of(path("decay.csv")), quiet;
  std::istringstream lines(text);
  std::vector<double> normal(20000);
  fill_standard_normal(StreamKey(9).with("node"), normal);
  std::size_t row = 0;
  for (std::string line; std::getline(lines, line); ++row) {
    quiet += line + (row == 0 ? ",n [g]" : fmt::format(",{:.6g}", 0.02 * normal[row])) + "\n";
  }
  write("decay.csv", quiet);
  write(
      "identify.yaml",
      "kind: identify\nstructure: {record: {file: decay.csv, responses: [{channel: a1}, {channel: "
      "n}]}}\n" +
          std::string(kBand));
  const StudyResult result = run_document(read_yaml_file(path("identify.yaml")));
  EXPECT_EQ(result.status, report::Status::kOk) << result.answer;
  EXPECT_THAT(result.summary, HasSubstr("% of n, which tells little"));
}

// Its frequency is a thousandth higher at first, as the square of the amplitude is.
TEST_F(DecayingStructureTest, AModeThatChangesWithItsAmplitudeIsNamed) {
  std::string text = "t [s],a1 [g],a2 [g],d [mm]\n";
  const double omega = 2.0 * std::numbers::pi * 120.0, decay = 0.003 * omega;
  const auto count = static_cast<std::size_t>(1.5 * kRate);
  std::vector<double> normal(3 * count);
  fill_standard_normal(StreamKey(6).with("noise"), normal);
  for (std::size_t j = 0; j < count; ++j) {
    const double t = static_cast<double>(j) / kRate, left = std::exp(-decay * t);
    const double phase = omega * (t + 1e-3 * (1.0 - left * left) / (2.0 * decay));
    const double motion = left * std::cos(phase);
    text += fmt::format("{:.6f},{:.9g},{:.9g},{:.9g}\n", t, motion + 0.003 * normal[3 * j],
                        -0.7 * motion + 0.003 * normal[3 * j + 1],
                        0.4 * motion + 0.003 * normal[3 * j + 2]);
  }
  write("decay.csv", text);
  const StudyResult result = run_document(document(kBand));
  EXPECT_THAT(result.summary, HasSubstr("modes at one place have one shape: 1")) << result.summary;
}

// A twelfth of a half-width apart, half as loud, the other one is not seen: the deviation of noise
// alone is less than a fifth of what it moves the damping ratio by.
TEST_F(DecayingStructureTest, AnUnseenPoleIsInTheColumnsForIt) {
  constexpr Mode kPair[] = {{141.6, 0.0018, {1.0, 0.6, -0.3}}, {141.62, 0.0023, {0.5, 0.3, -0.15}}};
  std::string text = "t [s],a1 [g],a2 [g],d [mm]\n";
  const auto count = static_cast<std::size_t>(2.0 * kRate);
  std::vector<double> normal(3 * count);
  fill_standard_normal(StreamKey(8).with("noise"), normal);
  for (std::size_t j = 0; j < count; ++j) {
    const double t = static_cast<double>(j) / kRate;
    text += fmt::format("{:.6f}", t);
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0.02 * normal[3 * j + k];
      for (const auto& [frequency, ratio, amplitudes] : kPair) {
        const double omega = 2.0 * std::numbers::pi * frequency;
        sum += amplitudes[k] * std::exp(-ratio * omega * t) * std::cos(omega * t);
      }
      text += fmt::format(",{:.9g}", sum);
    }
    text += "\n";
  }
  write("decay.csv", text);
  const StudyResult result = run_document(document(kBand));
  EXPECT_EQ(result.status, report::Status::kOk) << result.answer;
  const auto found = nlohmann::json::parse(result.files.at(0).second);
  ASSERT_EQ(found["modes"].size(), 1u) << found.dump(1);
  const auto of = [&](const char* key) { return found["modes"][0][key].get<double>(); };
  const double off = std::abs(of("zeta") - kPair[0].ratio);
  EXPECT_GT(off, 5.0 * of("zeta_sd"));
  EXPECT_LT(off, 2.0 * of("zeta_unseen"));
  EXPECT_LT(std::abs(of("f_hz") - kPair[0].frequency), 2.0 * of("f_unseen_hz"));
}

TEST_F(DecayingStructureTest, IsNoStringAndHasNoForce) {
  write_decay(0.02);
  const auto mistakes = [&](const std::string& keys) {
    const LoadedExperiment experiment = load_experiment(document(keys));
    return format_mistakes(experiment.document, experiment.mistakes);
  };
  EXPECT_THAT(mistakes("fundamental: 31 Hz\n"), HasSubstr("numbered in order"));
  EXPECT_THAT(mistakes("record: {file: decay.csv, left: {channel: a1}}\n"), HasSubstr("keep one"));
  EXPECT_THAT(mistakes("    exponential_window: 1 s\n"), HasSubstr("makes noise grow"));
  EXPECT_THAT(mistakes("identification: {lowest_frequency: 300 Hz, highest_frequency: 20 Hz}\n"),
              HasSubstr("is not above"));
  write("identify.yaml",
        "kind: identify\nstructure: {record: {file: decay.csv, force: {channel: a2}, responses: "
        "[{channel: a1}]}}\n");
  const LoadedExperiment forced = load_experiment(read_yaml_file(path("identify.yaml")));
  EXPECT_THAT(format_mistakes(forced.document, forced.mistakes), HasSubstr("kind: fit_modes"));
}

}  // namespace
}  // namespace modcal::identify_structure_test
