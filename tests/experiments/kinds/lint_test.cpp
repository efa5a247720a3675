// What validation says about a scene that its simulator cannot simulate: place, value, reason and
// remedy, before anything runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/loader.hpp"

namespace modcal {
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

std::string strokes(const std::string& calibration, const std::string& further) {
  return "kind: calibrate\n"
         "scene:\n"
         "  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz}\n"
         "  bow: {position: 30 mm}\n"
         "  duration: 0.1 s\n"
         "calibration: {parameters: {frequencies: all, law: true, contact: true}" +
         calibration + "}\nfurther_strokes: " + further + "\n";
}

TEST(LintStrokes, RefusesWhatCannotBeFittedTogether) {
  EXPECT_THAT(messages_of(strokes("", "{contacts: [28 mm]}")),
              testing::AllOf(testing::HasSubstr("scene.yaml:7:"),
                             testing::HasSubstr("state calibration.continuation")));
  EXPECT_THAT(messages_of(strokes(", continuation: {}", "{contacts: [28 mm, 0.4 m]}")),
              testing::HasSubstr("0.4 m is not on the string"));
  EXPECT_THAT(messages_of(strokes(", continuation: {}", "{records: [second.wav]}")),
              testing::HasSubstr("name further contacts"));
  EXPECT_EQ(messages_of(strokes(", continuation: {}", "{contacts: [28 mm]}")).find("error"),
            std::string::npos);
}

}  // namespace
}  // namespace modcal
