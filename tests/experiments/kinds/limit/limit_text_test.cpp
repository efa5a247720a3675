// What `modcal limit` says of a file: rows of all that is free, blind modes by all records
// together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/loader.hpp"
#include "libsim/base/error.hpp"

namespace modcal::limit_text_test {
namespace {

// Bowed at a fifth of its length, a node of modes 5 and 10.
std::string config(const std::string& parameters, const std::string& rest) {
  return "kind: calibrate\n"
         "scene:\n"
         "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 11}\n"
         "  bow: {position: 66 mm, velocity: 0.1 m/s, normal_force: 1 N}\n"
         "  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}\n"
         "  duration: 0.3 s\n"
         "simulator: modal_event\n"
         "measurement: {sample_rate: 12.5 kHz, noise_level: 0.5 %}\n"
         "calibration:\n"
         "  parameters: {frequencies: all, law: true, contact: true, law_width: 0.2 %" +
         (parameters.empty() ? ", damping: factor" : parameters) +
         "}\n  objective: joint_likelihood\n  optimizer: staged\n" + rest;
}

std::string limit_of(const std::string& text) {
  const LoadedExperiment loaded = load_experiment(parse_yaml(text, "scene.yaml"));
  EXPECT_FALSE(loaded.has_errors()) << format_mistakes(loaded.document, loaded.mistakes);
  TruthCache truths;
  return limit_text(*loaded.experiment->limit_question(), truths);
}

TEST(LimitText, NamesBlindModesAndContactsWithoutThem) {
  const std::string text = limit_of(config("", ""));
  EXPECT_THAT(text, testing::ContainsRegex("  5  980.000 [^\n]*blind \\(node\\)"));
  EXPECT_THAT(text,
              testing::HasSubstr("2 modes are not identified; contact points nearby:\n  x_c"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("gain")));
}

TEST(LimitText, APluckThatSeesThemLeavesNothingToPropose) {
  const std::string text = limit_of(
      config("",
             "plucks: [{initial: {type: pluck, position: 43 mm, displacement: 1 mm, width: 3 mm}, "
             "duration: 0.3 s, noise_level: 1 %, sample_rate: 12.5 kHz}]\n"));
  EXPECT_THAT(text, testing::HasSubstr("pluck 1: noise 1 % of each reaction, 0.3 s at 12500 Hz"));
  EXPECT_THAT(text, testing::ContainsRegex("  5  980.000 [^\n]*identified"));
  EXPECT_THAT(text, testing::HasSubstr("no mode is blind to all records"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("contact points nearby")));
}

TEST(LimitText, FurtherStrokesHaveContactsOfTheirOwn) {
  const std::string text = limit_of(config("", "further_strokes: {contacts: [62 mm]}\n"));
  EXPECT_THAT(text, testing::HasSubstr("stroke 2: x_c = 0.062 m"));
  EXPECT_THAT(text, testing::ContainsRegex("  x_c 2 +sd [^\n]* m "));
  EXPECT_THAT(text, testing::HasSubstr("no mode is blind to all records"));
}

TEST(LimitText, HasARowForEveryFreeParameterInBothStages) {
  const std::string text = limit_of(config(", damping: power, sensors: [gain, delay]", ""));
  const std::size_t free = text.find("every frequency free");
  ASSERT_NE(free, std::string::npos);
  for (const std::string& stage : {text.substr(0, free), text.substr(free)}) {
    EXPECT_THAT(stage, testing::ContainsRegex("gain +sd [0-9]"));
    EXPECT_THAT(stage, testing::ContainsRegex("delay +sd [0-9][^\n]* s"));
    EXPECT_THAT(stage, testing::ContainsRegex("damping_power +sd [0-9]"));
    EXPECT_THAT(stage, testing::Not(testing::HasSubstr("corner")));
  }
  EXPECT_THAT(limit_of(config(", damping: each", "")),
              testing::HasSubstr("relative sd  sd of zeta  verdict"));
}

// The relative deviation of mode n where every frequency is free.
double deviation_of(std::size_t mode, const std::string& text) {
  std::istringstream lines(text.substr(text.find("relative sd")));
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::size_t number = 0;
    double frequency = 0.0, deviation = 0.0;
    if (words >> number >> frequency >> deviation && number == mode) return deviation;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// Numbers behind "NAME sd": the deviation, and in brackets, where it stands, the attainable one.
std::vector<double> printed_deviations(const std::string& text, const std::string& name) {
  std::istringstream lines(text);
  std::string line, first, second, number;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    if (!(words >> first >> second >> number) || first != name || second != "sd") continue;
    std::vector<double> result = {std::stod(number)};
    if (words >> number && number[0] == '(') result.push_back(std::stod(number.substr(1)));
    return result;
  }
  return {};
}

// Text and file have the same deviations, each in its place, to the text's three digits.
TEST(LimitJson, HasEveryDeviationOfTheText) {
  const LoadedExperiment loaded =
      load_experiment(parse_yaml(config(", damping: power, sensors: [gain]", ""), "scene.yaml"));
  TruthCache truths;
  const LimitQuestion question = *loaded.experiment->limit_question();
  const auto document = limit_json(question, truths);
  const std::string text = limit_text(question, truths);
  const std::string free = text.substr(text.find("every frequency free"));
  ASSERT_EQ(document.at("modes").size(), 11u);
  for (std::size_t n = 1; n <= 11; ++n) {
    const double stated = document.at("modes")[n - 1].at("relative_sd").get<double>();
    EXPECT_NEAR(deviation_of(n, text) / stated, 1.0, 0.006) << n;
  }
  std::size_t with_frequencies = 0;
  for (const auto& row : document.at("parameters")) {
    const auto name = row.at("name").get<std::string>();
    const std::vector<double> law = printed_deviations(text, name);
    ASSERT_EQ(law.size(), 2u) << name;
    EXPECT_NEAR(law[0] / row.at("sd").get<double>(), 1.0, 0.006) << name;
    EXPECT_NEAR(law[1] / row.at("attainable_sd").get<double>(), 1.0, 0.006) << name;
    // At 0.5 % noise a force that is not known costs next to nothing.
    EXPECT_NEAR(law[1] / law[0], 1.0, 0.1) << name;
    const std::vector<double> alone = printed_deviations(free, name);
    if (alone.empty()) continue;
    EXPECT_NEAR(alone[0] / row.at("sd_with_free_frequencies").get<double>(), 1.0, 0.006) << name;
    ++with_frequencies;
  }
  EXPECT_EQ(with_frequencies, 2u);  // damping_power and gain; x_c and damping have no row there
}

TEST(LimitText, CountsWhatASmoothResponseTakes) {
  const double gain = deviation_of(1, limit_of(config(", sensors: [gain]", "")));
  const double response = deviation_of(
      1, limit_of(config(", sensors: [gain, response], response_spacing: 300 Hz", "")));
  EXPECT_GT(response, 1.2 * gain);
  EXPECT_LT(response, 100.0 * gain);
}

TEST(LimitText, NamesNoFixedContactAmongTheDeviations) {
  const std::string fixed =
      limit_of(config(", damping: factor, fixed: [{parameter: x_c, value: 66 mm}]", ""));
  EXPECT_THAT(fixed, testing::HasSubstr("every frequency free: sd of the damping factor "));
  EXPECT_THAT(limit_of(config("", "")),
              testing::ContainsRegex("every frequency free: sd of x_c [^\n]* m, of the damping"));
}

TEST(LimitText, RefusesAStringThatNothingMoves) {
  std::string silent = config("", "");
  silent.replace(silent.find("normal_force: 1 N"), 17, "normal_force: 0 N");
  try {
    limit_of(silent);
    FAIL();
  } catch (const InvalidInput& refusal) {
    EXPECT_THAT(refusal.what(), testing::HasSubstr("normal force > 0"));
  }
}

TEST(LimitText, OfARecordAsksForASceneBeforeAnythingElse) {
  TruthCache truths;
  LimitQuestion question;
  question.observation.has_record = true;
  try {
    limit_text(question, truths);
    FAIL();
  } catch (const InvalidInput& refusal) {
    EXPECT_THAT(refusal.what(), testing::HasSubstr("state a scene, not a record"));
  }
}

}  // namespace
}  // namespace modcal::limit_text_test
