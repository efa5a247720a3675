// What validation says about a scene that its simulator cannot simulate: place, value, reason and
// remedy, before anything runs.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/loader.hpp"

namespace modcal::lint_test {
namespace {

std::string config(const std::string& friction, const std::string& bow,
                   const std::string& simulator) {
  return "kind: simulate\n"
         "scene:\n"
         "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
         "  bow: {position: 30 mm" +
         bow + "}\n  friction: {type: " + friction +
         "}\n"
         "  duration: 10 ms\n"
         "simulator: {type: " +
         simulator +
         "}\n"
         "outputs: [v]\n";
}

std::string messages_of(const std::string& text) {
  const LoadedExperiment loaded = load_experiment(parse_yaml(text, "scene.yaml"));
  EXPECT_EQ(loaded.experiment == nullptr, loaded.has_errors());
  return format_mistakes(loaded.document, loaded.mistakes);
}

TEST(LintSimulator, RefusesBristlesUnderTheEventDrivenIntegrator) {
  const std::string messages = messages_of(config("elasto_plastic", "", "modal_event"));
  EXPECT_THAT(messages, testing::HasSubstr("scene.yaml:5:"));
  EXPECT_THAT(messages, testing::HasSubstr("elasto_plastic"));
  EXPECT_THAT(messages, testing::HasSubstr("use modal_exact or newmark_explicit"));
}

TEST(LintSimulator, RefusesSeveralContactPointsUnderTheEventDrivenIntegrator) {
  const std::string messages =
      messages_of(config("coulomb_exponential", ", width: 5 mm, points: 3", "modal_event"));
  EXPECT_THAT(messages, testing::HasSubstr("scene.yaml:4:"));
  EXPECT_THAT(messages, testing::HasSubstr("3 contact points"));
  EXPECT_THAT(messages, testing::HasSubstr("use modal_exact or newmark_explicit"));
}

TEST(LintSimulator, HasNothingAgainstWhatTheSimulatorFollows) {
  EXPECT_EQ(messages_of(config("thermal", "", "modal_event")), "");
  EXPECT_EQ(messages_of(config("elasto_plastic", "", "modal_exact")), "");
  EXPECT_EQ(messages_of(config("hyperbolic", ", width: 5 mm, points: 3", "modal_exact")), "");
}

// A scene has no record that tells how many modes there are.
TEST(LintScene, AsksForTheNumberOfModes) {
  std::string text = config("thermal", "", "modal_event");
  text.insert(text.find("196 Hz") + 6, ", modes: auto");
  EXPECT_THAT(messages_of(text), testing::HasSubstr("scene.yaml:3:"));
  EXPECT_THAT(messages_of(text), testing::HasSubstr("state a number of modes"));
}

std::string strokes(const std::string& calibration, const std::string& further) {
  return "kind: calibrate\n"
         "scene:\n"
         "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
         "  bow: {position: 30 mm}\n"
         "  duration: 0.1 s\n"
         "calibration: {parameters: {frequencies: all, law: true, contact: true}" +
         calibration + "}\nfurther_strokes: " + further + "\n";
}

std::string search(const std::string& objective, const std::string& optimizer) {
  return "kind: calibrate\n"
         "scene:\n"
         "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
         "  bow: {position: 30 mm}\n"
         "  duration: 0.1 s\n"
         "calibration:\n"
         "  parameters: {frequencies: none, law: false}\n"
         "  objective: " +
         objective + "\n  optimizer: " + optimizer + "\n";
}

TEST(LintSearch, SaysWhereAnOptimizerCannotMinimizeTheObjective) {
  for (const std::string objective :
       {"spectral_peak", "contact_location",
        "{type: weighted_sum, terms: [{objective: force_mismatch}, {objective: spectral_peak}]}"}) {
    EXPECT_THAT(messages_of(search(objective, "ceres")),
                testing::AllOf(testing::HasSubstr("scene.yaml:9:"),
                               testing::HasSubstr("\"ceres\" needs residuals"),
                               testing::HasSubstr("nlopt")))
        << objective;
    EXPECT_EQ(messages_of(search(objective, "nlopt")).find("error"), std::string::npos);
  }
  for (const std::string objective : {"contact_location_squares", "innovation_misfit"}) {
    EXPECT_EQ(messages_of(search(objective, "ceres")).find("error"), std::string::npos);
  }
}

TEST(LintSearch, RefusesEstimatesThatACalibrationDoesNotMake) {
  const std::string plain = search("spectral_peak", "nlopt");
  EXPECT_THAT(
      messages_of(plain + "wave_based: true\n"),
      testing::ContainsRegex("scene.yaml:10:[0-9]+: error: [^\n]*does not read wave_based"));
  EXPECT_THAT(messages_of(plain + "model_based: {}\n"),
              testing::ContainsRegex("scene.yaml:10:[0-9]+: error: [^\n]*read model_based"));
}

constexpr const char* kStaged = ", objective: joint_likelihood, optimizer: staged";

TEST(LintStrokes, RefusesWhatCannotBeFittedTogether) {
  EXPECT_THAT(
      messages_of(
          strokes(", objective: spectral_peak, optimizer: mode_by_mode", "{contacts: [28 mm]}")),
      testing::AllOf(testing::HasSubstr("scene.yaml:7:"),
                     testing::HasSubstr("state objective: joint_likelihood, optimizer: staged")));
  EXPECT_THAT(messages_of(strokes(kStaged, "{contacts: [28 mm, 0.4 m]}")),
              testing::HasSubstr("0.4 m is not on the string"));
  EXPECT_THAT(messages_of(strokes(kStaged, "{records: [second.wav]}")),
              testing::HasSubstr("name further contacts"));
  EXPECT_EQ(messages_of(strokes(kStaged, "{contacts: [28 mm]}")).find("error"), std::string::npos);
}

TEST(LintStaged, RefusesWhatItWouldNotRead) {
  const auto messages = [](const std::string& parameters, const std::string& calibration) {
    std::string text = strokes(calibration, "{contacts: [28 mm]}");
    const std::string plain = "{frequencies: all, law: true, contact: true}";
    return messages_of(text.replace(text.find(plain), plain.size(), parameters));
  };
  const std::string all = "{frequencies: all, law: true, contact: true}";
  EXPECT_EQ(messages(all, std::string(kStaged) + ", budget: {evaluations: 10}").find("error"),
            std::string::npos);
  EXPECT_THAT(messages("{frequencies: listed, modes: [3], law: true, contact: true}", kStaged),
              testing::ContainsRegex("scene.yaml:6:[0-9]+: error: [^\n]*fixed: ..parameter: f_3"));
  EXPECT_THAT(messages("{frequencies: all, contact: false}", kStaged),
              testing::HasSubstr("contact: false holds the contact of one stroke"));
  EXPECT_THAT(messages(all,
                       ", objective: {type: joint_likelihood, highest_frequency: 300}, "
                       "optimizer: staged"),
              testing::ContainsRegex("scene.yaml:6:[0-9]+: error: highest_frequency 300 Hz: below "
                                     "it lie fewer than the 2 modes[^\n]*more than 392 Hz"));
  EXPECT_EQ(messages(all,
                     ", objective: {type: joint_likelihood, highest_frequency: 400}, "
                     "optimizer: staged")
                .find("error"),
            std::string::npos);
  EXPECT_THAT(messages(all, ", objective: force_mismatch, optimizer: staged"),
              testing::HasSubstr("\"force_mismatch\" has none: state its stages"));
}

TEST(LintStaged, IsTheOneThatReadsPriors) {
  const auto messages = [](const std::string& parameters) {
    return messages_of(
        std::string("kind: calibrate\nscene:\n"
                    "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
                    "  bow: {position: 30 mm}\n  duration: 1 s\n"
                    "calibration: {parameters: {frequencies: all, ") +
        parameters + "}, objective: spectral_peak, optimizer: nlopt}\n");
  };
  EXPECT_EQ(messages("contact: true").find("error"), std::string::npos);
  EXPECT_THAT(messages("law_width: 1 %"), testing::HasSubstr("law_width is read by the joint"));
  EXPECT_THAT(messages("priors: [{parameter: x_c, deviation: 1 mm}]"),
              testing::ContainsRegex("scene.yaml:6:[0-9]+: error: priors is read by the joint"));
}

TEST(LintStaged, SaysHowAContinuationIsWrittenNow) {
  EXPECT_THAT(messages_of(strokes(", continuation: {}", "{contacts: []}")),
              testing::ContainsRegex("scene.yaml:6:[0-9]+: error: \"continuation\" is now the "
                                     "optimizer \"staged\": write objective: "));
}

std::string limit_of(const std::string& bow, const std::string& rest) {
  return "kind: calibration_limit\n"
         "scene:\n"
         "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
         "  bow: " +
         bow + "\n  duration: 1 s\n" + rest;
}

TEST(LintCalibrationLimit, FindsWhatEveryTaskWouldFailOf) {
  using testing::HasSubstr;
  const std::string bow = "{position: 30 mm}";
  EXPECT_EQ(messages_of(limit_of(bow, "model_error: {contact: 29 mm}\n")), "");
  EXPECT_THAT(messages_of(limit_of("{position: 0.4 m}", "")),
              testing::AllOf(HasSubstr("scene.yaml:4:"), HasSubstr("0.4 m is outside the string")));
  EXPECT_THAT(messages_of(limit_of(bow, "measurement: {sample_rate: 8 kHz}\n")),
              HasSubstr("is not below half the sample rate"));
  // The draws lie on both sides of the contact point.
  EXPECT_THAT(messages_of(limit_of(bow, "model_error: {contact: 31 mm}\n")),
              testing::AllOf(HasSubstr("scene.yaml:6:"), HasSubstr("not inside the string")));
  EXPECT_THAT(
      messages_of(limit_of(bow,
                           "calibration: {parameters: {}, objective: {type: joint_likelihood, "
                           "highest_frequency: 300}}\n")),
      testing::AllOf(HasSubstr("scene.yaml:6:"), HasSubstr("more than 392 Hz")));
}

// Two priors that are wrong and one that is not, then correlations; each in a line of its own.
constexpr const char* kPriors =
    "    damping: power\n"
    "    priors:\n"
    "      - {parameter: x_c, mean: 30 mm, deviation: 1 mm}\n"
    "      - {parameter: f_99, deviation: 1 Hz}\n"
    "      - {parameter: gain, deviation: 1 %}\n"
    "      - {parameter: damping, deviation: 1 %}\n"
    "    correlations:\n"
    "      - {between: [x_c, damping], value: 0.5}\n"
    "      - {between: [x_c, f_99], value: 0.5}\n"
    "      - {between: [x_c, f_1], value: 0.5}\n";

constexpr const char* kScene =
    "scene:\n"
    "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
    "  bow: {position: 30 mm}\n"
    "  duration: 1 s\n";

// first: line of "priors:".
void expect_mistakes_of_priors(const std::string& messages, std::size_t first) {
  const auto at = [&](std::size_t line, const char* text) {
    const std::string place = fmt::format("scene.yaml:{}:", first + line);
    EXPECT_THAT(messages, testing::ContainsRegex(place + "[0-9]+: error: [^\n]*" + text));
  };
  at(2, "f_99");
  at(3, "gain has a prior and is not free");
  at(8, "\"f_1\", which has no prior");
  for (const std::size_t sound : {1u, 4u, 6u, 7u}) {
    EXPECT_THAT(messages,
                testing::Not(testing::HasSubstr(fmt::format("scene.yaml:{}:", first + sound))));
  }
}

TEST(LintPriors, ReportsEachMistakeAtItsOwnPlaceInEveryKindThatHasPriors) {
  expect_mistakes_of_priors(messages_of(std::string("kind: calibrate\n") + kScene +
                                        "calibration:\n"
                                        "  objective: joint_likelihood\n"
                                        "  optimizer: staged\n"
                                        "  parameters:\n"
                                        "    frequencies: none\n" +
                                        kPriors),
                            12);
  expect_mistakes_of_priors(messages_of(std::string("kind: calibration_limit\n") + kScene +
                                        "calibration:\n  parameters:\n" + kPriors),
                            9);
  expect_mistakes_of_priors(
      messages_of(std::string("kind: pluck_then_bow\n") + kScene +
                  "pluck: {initial: {type: pluck, position: 43 mm, displacement: 1 mm}}\n"
                  "contact: {start: 30 mm}\n"
                  "bound:\n  parameters:\n" +
                  kPriors),
      11);
}

TEST(LintPriors, ReportsCorrelationsThatNoGaussianHasAtTheLastOfThem) {
  const std::string messages = messages_of(std::string("kind: calibration_limit\n") + kScene +
                                           "calibration:\n"
                                           "  parameters:\n"
                                           "    priors:\n"
                                           "      - {parameter: x_c, deviation: 1 mm}\n"
                                           "      - {parameter: f0, deviation: 1 Hz}\n"
                                           "      - {parameter: B, mean: 0, deviation: 1e-5}\n"
                                           "    correlations:\n"
                                           "      - {between: [x_c, f0], value: 0.6}\n"
                                           "      - {between: [f0, B], value: 0.6}\n"
                                           "      - {between: [x_c, B], value: -0.9}\n");
  EXPECT_THAT(messages, testing::ContainsRegex("scene.yaml:15:[0-9]+: error: [^\n]*no Gaussian"));
  EXPECT_THAT(messages, testing::Not(testing::HasSubstr("scene.yaml:14:")));
}

std::string plucks(const std::string& first, const std::string& second) {
  return std::string("kind: calibrate\n") + kScene +
         "calibration: {parameters: {frequencies: all, law: true, contact: true}, objective: "
         "joint_likelihood, optimizer: staged}\nplucks:\n  - " +
         first + "\n  - " + second + "\n";
}

TEST(LintPlucks, RefusesPlucksBeyondTheStringAndDecaysTooShort) {
  const std::string messages = messages_of(
      plucks("{initial: {type: pluck, position: 0.4 m, displacement: 1 mm}, duration: 1 s}",
             "{initial: {type: pluck, position: 43 mm, displacement: 1 mm}, duration: 5 ms}"));
  EXPECT_THAT(
      messages,
      testing::AllOf(testing::ContainsRegex("scene.yaml:8:[0-9]+: error: [^\n]*0.4 m is not "
                                            "inside the string[^\n]*0.33"),
                     testing::ContainsRegex("scene.yaml:9:[0-9]+: error: [^\n]*0.005 s[^\n]*at "
                                            "least 2 periods[^\n]*0.0102 s")));
  EXPECT_EQ(messages_of(plucks("{initial: {type: pluck, position: 43 mm, displacement: 1 mm}}",
                               "{initial: {type: pluck, position: 50 mm, displacement: 1 mm}, "
                               "duration: 20 ms}"))
                .find("error"),
            std::string::npos);
}

TEST(LintPlucks, RefusesAPluckTestTooShortForItsIdentification) {
  const auto test_of = [](const std::string& pluck) {
    return messages_of(std::string("kind: pluck_then_bow\n") + kScene +
                       "contact: {start: 30 mm}\n" + "pluck: " + pluck + "\n");
  };
  const std::string start = "{initial: {type: pluck, position: 43 mm, displacement: 1 mm}";
  EXPECT_THAT(
      test_of(start + ", duration: 1 ms}"),
      testing::ContainsRegex("scene.yaml:7:[0-9]+: error: the first 0.002 s[^\n]*0.000996 s"));
  EXPECT_THAT(test_of(start + ", duration: 30 ms}"),
              testing::ContainsRegex("scene.yaml:7:[0-9]+: error: a decay of 0.03 s leaves [0-9]+ "
                                     "samples[^\n]*150 block rows: record"));
  EXPECT_EQ(test_of(start + ", duration: 0.2 s}").find("error"), std::string::npos);
  EXPECT_THAT(
      messages_of("kind: identify\nscene:\n"
                  "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
                  "  bow: {position: 30 mm, velocity: 0 m/s, normal_force: 0 N}\n"
                  "  initial: {type: pluck, position: 43 mm, displacement: 1 mm}\n"
                  "  duration: 30 ms\n"),
      testing::ContainsRegex("scene.yaml:6:[0-9]+: error: a decay of 0.03 s leaves"));
  EXPECT_THAT(test_of("{initial: {type: pluck, position: 0.4 m, displacement: 1 mm}}"),
              testing::ContainsRegex("scene.yaml:7:[0-9]+: error: [^\n]*0.4 m is not inside"));
}

TEST(PlanPlucks, CountsTheirSimulationsOnce) {
  const std::string one =
      "{initial: {type: pluck, position: 43 mm, displacement: 1 mm}, duration: 0.5 s}";
  const std::string other = "{initial: {type: pluck, position: 50 mm, displacement: 1 mm}}";
  const auto planned_of = [](const std::string& text) {
    return load_experiment(parse_yaml(text, "scene.yaml")).experiment->planned_simulations();
  };
  const auto two = planned_of(plucks(one, other));
  ASSERT_EQ(two->others.size(), 2u);
  EXPECT_EQ(two->count, 1u);
  EXPECT_EQ(two->others[0].truth.scene.duration, 0.5);
  EXPECT_EQ(two->others[0].truth.scene.bow.normal_force, 0.0);
  EXPECT_EQ(two->others[1].truth.scene.duration, 1.0);
  EXPECT_EQ(planned_of(plucks(one, one))->others.size(), 1u);
  const LoadedExperiment loaded = load_experiment(parse_yaml(plucks(one, other), "scene.yaml"));
  EXPECT_THAT(loaded.experiment->plan().front().text, testing::HasSubstr("1 of 0.5 s"));
}

std::string sampled(const std::string& rate, const std::string& calibration,
                    const std::string& plucks = "[]") {
  return "kind: calibrate\n"
         "scene:\n"
         "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 50}\n"
         "  bow: {position: 30 mm}\n"
         "  duration: 1 s\n"
         "measurement: {sample_rate: " +
         rate + "}\ncalibration: {parameters: {frequencies: all, law: true, contact: true}, " +
         calibration + "}\nplucks: " + plucks + "\n";
}

TEST(LintNoise, RefusesARecordThatDoesNotShowTheNoiseToEstimate) {
  const auto refused = [](const std::string& line) {
    return testing::AllOf(
        testing::HasSubstr("scene.yaml:" + line + ":"), testing::HasSubstr("22050 Hz"),
        testing::HasSubstr("State noise_rms_1 and noise_rms_2 (of a calibration in"));
  };
  EXPECT_THAT(messages_of(sampled("22.05 kHz", "objective: joint_likelihood, optimizer: staged")),
              refused("7"));
  EXPECT_THAT(messages_of(sampled("22.05 kHz", "objective: joint_likelihood")), refused("7"));
  EXPECT_THAT(messages_of(sampled("22.05 kHz",
                                  "objective: {type: weighted_sum, terms: [{weight: "
                                  "1, objective: joint_likelihood}]}, optimizer: ceres")),
              refused("7"));
  const std::string stated =
      "objective: {type: joint_likelihood, noise_rms_1: 3 mN, noise_rms_2: 4 mN}, optimizer: "
      "staged";
  EXPECT_EQ(messages_of(sampled("22.05 kHz", stated)).find("error"), std::string::npos);
  EXPECT_EQ(messages_of(sampled("25.6 kHz", "objective: joint_likelihood, optimizer: staged"))
                .find("error"),
            std::string::npos);
  EXPECT_EQ(
      messages_of(sampled("22.05 kHz", "objective: spectral_peak, optimizer: nlopt")).find("error"),
      std::string::npos);
  EXPECT_THAT(messages_of(sampled("51.2 kHz", "objective: joint_likelihood, optimizer: staged",
                                  "[{initial: {type: pluck, position: 0.1 m, displacement: 1 mm}, "
                                  "sample_rate: 22.05 kHz}]")),
              refused("8"));
}

TEST(LintFigures, NamesTheLineOfAWindowOutsideTheRecord) {
  const std::string text = config("thermal", "", "modal_event") +
                           "figures:\n"
                           "  - {id: a, quantities: [v], windows: [{start: 0 s}]}\n"
                           "  - id: b\n"
                           "    quantities: [v]\n"
                           "    windows:\n"
                           "      - {start: 1 ms, stop: 2 ms}\n"
                           "      - {start: 20 ms, stop: 30 ms}\n";
  EXPECT_THAT(messages_of(text),
              testing::StartsWith("scene.yaml:15:9: error: figure b: the window from 0.02 s to "
                                  "0.03 s holds nothing of a record of 0.01 s\n"));
}

}  // namespace
}  // namespace modcal::lint_test
