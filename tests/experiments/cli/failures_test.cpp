// What a run says that has failed, wholly or in some of its tasks: how many, which, why, what to
// try.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::failures_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;

// A force with which the friction equation has no solution.
const std::string kStops =
    "the simulation by modal_event stops at 0 s: the friction equation has no solution on any "
    "step: the force falls too steeply with the speed, or the state is not finite; check the "
    "values of scene.bow and scene.friction, take a shorter simulator.time_step, or another "
    "simulator\n";

class Failures : public testing::ProgramTest {
 protected:
  Failures() {
    std::string text = testing::kSmallSimulation;
    text.replace(text.find("simulator: "),
                 text.find('\n', text.find("simulator: ")) - text.find("simulator: "),
                 "simulator: modal_event");
    write("one.yaml", text);
    write("list.yaml", text +
                           "sweep:\n  product:\n    scene.bow.normal_force: [1 N, 1e150 N]\n"
                           "    seed: [1, 2, 3, 4, 5, 6]\n");
    text.replace(text.find("simulate"), 8, "sweep");
    write("sweep.yaml", text +
                            "score: {windows: [0.05 s]}\nsweep:\n  product:\n"
                            "    scene.bow.normal_force: [1 N, 1e150 N]\n");
  }
};

TEST_F(Failures, OfASimulationSayWhyAndWhatToTry) {
  const Outcome outcome = modcal("run one.yaml --set 'scene.bow.normal_force=1e150 N'");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, EndsWith("error: " + kStops));
}

TEST_F(Failures, OfTasksStandOnTheLastLines) {
  const std::string last = "6 of 12 tasks failed:\n  task 6, 7, 8, 9, 10 … (6 tasks): " + kStops +
                           "one of them again: modcal replay a 6\n";
  const Outcome run = modcal("run list.yaml --out a");
  EXPECT_EQ(run.code, 4);
  EXPECT_THAT(run.out, EndsWith("settings, see tasks.csv\n" + last));
  EXPECT_THAT(modcal("report a").out, EndsWith(last));
  EXPECT_THAT(content_of(folder() / "a/report.html"),
              AllOf(HasSubstr("6 of 12 tasks failed:"), HasSubstr("task 6, 7, 8, 9, 10")));
  EXPECT_EQ(modcal("replay a 6").code, 3);
  EXPECT_EQ(modcal("replay a 5").code, 0);
  const json answer = json::parse(modcal("report a --json").out);
  EXPECT_EQ(answer["error"]["kind"], "some_tasks_failed");
  ASSERT_EQ(answer["failures"].size(), 1u);
  EXPECT_EQ(answer["failures"][0]["count"], 6);
  EXPECT_EQ(answer["failures"][0]["reason"].get<std::string>() + "\n", kStops);
  EXPECT_THAT(modcal("run list.yaml --out b --shard 2/2").out,
              HasSubstr("3 of 12 tasks failed:\n  task 7, 9, 11: "));
}

TEST_F(Failures, OfASweepAreSaidOnce) {
  const Outcome run = modcal("run sweep.yaml --out a");
  EXPECT_EQ(run.code, 4) << run.err;
  EXPECT_THAT(run.out, HasSubstr("1 of 2 tasks failed:\n  task 1: " + kStops));
  const std::size_t first = run.out.find("tasks failed");
  EXPECT_EQ(run.out.find("tasks failed", first + 1), std::string::npos);
}

}  // namespace
}  // namespace modcal::failures_test
