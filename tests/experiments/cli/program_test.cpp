// The program from outside: exit codes, what goes to which stream, what stays in the folder.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/cli/program_run.hpp"
#include "tests/experiments/config/json_schema.hpp"

namespace modcal::program_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kExperiment = "kind: invert\ntitle: small\n" + testing::kSmallScene +
                                R"(measurement: {sample_rate: 12.5 kHz}
inversion: {estimator: one_sided, regularizer: none}
seed: 7
)";

class Program : public testing::ProgramTest {
 protected:
  Program() { write("small.yaml", kExperiment); }
};

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

TEST_F(Program, EndsWithTwoForAWrongCommandLine) {
  for (const char* arguments :
       {"", "run", "run small.yaml --nonsense", "run small.yaml --threads 0",
        "run small.yaml --threads x", "describe damping"}) {
    const Outcome outcome = modcal(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, Not(IsEmpty()));
  }
  EXPECT_EQ(modcal("valdate small.yaml").err,
            "error: unknown command \"valdate\"; did you mean \"validate\"?\n");
}

TEST_F(Program, SaysItsVersionOnStdout) {
  const Outcome outcome = modcal("--version");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, StartsWith("modcal "));
  EXPECT_THAT(outcome.out, HasSubstr("commit "));
}

TEST_F(Program, ValidatesOnStdoutAndComplainsOnStderr) {
  const Outcome valid = modcal("validate small.yaml");
  EXPECT_EQ(valid.code, 0);
  EXPECT_EQ(valid.out, "small.yaml: valid, kind invert\n");
  const Outcome wrong = modcal(
      "validate small.yaml --set scene.bow.position='400 mm' "
      "--set measurement.sample_rate='1 kHz' --set sede=1");
  EXPECT_EQ(wrong.code, 3);
  EXPECT_THAT(wrong.out, IsEmpty());
  EXPECT_THAT(wrong.err, HasSubstr("contact point 0.4 m is outside the string of 0.33 m"));
  EXPECT_THAT(wrong.err, HasSubstr("is not below half the sample rate"));
  EXPECT_THAT(wrong.err, HasSubstr("unknown key \"sede\"; did you mean \"seed\"?"));
}

TEST_F(Program, ReportsTheMissingSectionAndNothingThatFollowsFromIt) {
  std::string text(kExperiment);
  const std::size_t start = text.find("  string:");
  text.erase(start, text.find('\n', start) + 1 - start);
  write("wrong.yaml", text);
  const Outcome outcome = modcal("validate wrong.yaml");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.err,
            "wrong.yaml:4:3: error: missing key \"string\": the string; it needs length, "
            "linear_density, fundamental\n"
            "      bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}\n"
            "      ^\n");
}

TEST_F(Program, EndsWithThreeWhereAFileCannotBeRead) {
  const Outcome missing = modcal("run missing.yaml");
  EXPECT_EQ(missing.code, 3);
  EXPECT_EQ(missing.err,
            "error: missing.yaml: cannot be opened: No such file or directory; check the path and "
            "its permissions\n");
  const Outcome folder = modcal("run .");
  EXPECT_EQ(folder.code, 3);
  EXPECT_EQ(folder.err, "error: .: this is a folder, not a file\n");
}

TEST_F(Program, FindsAnUnwritableFolderBeforeComputing) {
  write("file", "kept");
  for (const char* out : {"file", "file/below", "/proc/modcal"}) {
    // An hour of scene: the test would not end if it were simulated first.
    const Outcome outcome = modcal(
        std::string("run small.yaml --memory 1TB --set scene.duration='3100 s' --out ") + out);
    EXPECT_EQ(outcome.code, 3) << out;
    EXPECT_THAT(outcome.err, HasSubstr(std::string("the output folder ") + out));
    EXPECT_THAT(outcome.err, HasSubstr("choose another one with --out"));
  }
  EXPECT_EQ(content_of(folder() / "file"), "kept");
}

TEST_F(Program, LeavesAResolvedConfigurationThatGivesTheSameResults) {
  const Outcome first = modcal("run small.yaml --out a --set scene.bow.normal_force='0.9 N'");
  ASSERT_EQ(first.code, 0) << first.err;
  const Outcome again = modcal("run a/resolved.yaml --out b");
  ASSERT_EQ(again.code, 0) << again.err;
  // The first line names the file that was read.
  const auto options = [&](const char* name) {
    const std::string text = content_of(folder() / name);
    return text.substr(text.find('\n'));
  };
  EXPECT_EQ(options("a/resolved.yaml"), options("b/resolved.yaml"));
  EXPECT_EQ(content_of(folder() / "a/identification.csv"),
            content_of(folder() / "b/identification.csv"));
  EXPECT_THAT(content_of(folder() / "a/resolved.yaml"), HasSubstr("normal_force: 0.9 N"));
  for (const std::string& name : names_in(folder() / "a")) {
    EXPECT_FALSE(name.starts_with(".")) << name;
  }
}

TEST_F(Program, WritesTheDefaultFolderAndWhereResultsComeFrom) {
  const Outcome outcome = modcal("run small.yaml --json --threads 1");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out)["out"], "out/small");
  const json provenance = json::parse(content_of(folder() / "out/small/provenance.json"));
  EXPECT_EQ(provenance["seeds"], json({{"seed", 7}}));
  for (const char* key : {"version", "commit", "dirty", "compiler", "libraries", "processor",
                          "hardware_threads", "system", "command", "time_utc"}) {
    EXPECT_TRUE(provenance.contains(key)) << key;
  }
  EXPECT_EQ(provenance["command"], "modcal run small.yaml --out out/small --threads 1");
}

TEST_F(Program, StopsOnASignalSaysHowToRunAgainAndDamagesNothing) {
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  const std::string before = content_of(folder() / "a/identification.csv");
  const std::string resolved = content_of(folder() / "a/resolved.yaml");
  // A tenth of a second of work is long after the handler stands.
  const Outcome outcome = shell("'" MODCAL_PROGRAM
                                "' run small.yaml --out a --set scene.duration='100 s' & pid=$!; "
                                "while [ $(cut -d ' ' -f 14 /proc/$pid/stat) -lt 10 ]; do sleep "
                                "0.02; done; kill -INT $pid; wait $pid");
  EXPECT_EQ(outcome.code, 130);
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err,
              HasSubstr("interrupted; run again with:\n  modcal run small.yaml --out a "
                        "--set 'scene.duration=100 s'\n"));
  EXPECT_EQ(content_of(folder() / "a/identification.csv"), before);
  EXPECT_EQ(content_of(folder() / "a/resolved.yaml"), resolved) << "it belongs to what stands";
  for (const std::string& name : names_in(folder() / "a")) {
    EXPECT_FALSE(name.starts_with(".")) << name;
  }
}

TEST_F(Program, PutsNoTerminalCodesIntoPipes) {
  for (const char* environment : {"", "NO_COLOR=1 ", "TERM=xterm-256color "}) {
    const Outcome outcome =
        shell(std::string(environment) + "'" MODCAL_PROGRAM "' validate small.yaml --set seed=x");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.out + outcome.err, Not(HasSubstr("\x1b")));
  }
}

TEST_F(Program, UsesNoColorsOnATerminalWhereTheyAreNotWanted) {
  // script(1) gives the program a terminal.
  const Outcome outcome = shell("NO_COLOR=1 script -qec \"'" MODCAL_PROGRAM
                                "' validate small.yaml --set seed=x\" /dev/null");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("seed must be a whole number"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("\x1b")));
}

TEST_F(Program, MarksMistakesOnATerminal) {
  const auto on_terminal = [this](const std::string& environment) {
    return shell(environment + " script -qec \"'" MODCAL_PROGRAM
                               "' validate small.yaml --set seed=x\" /dev/null");
  };
  const Outcome outcome = on_terminal("env -u NO_COLOR TERM=xterm");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("\x1b[1;31merror:\x1b[0m seed must be a whole number"));
  EXPECT_THAT(on_terminal("env -u NO_COLOR TERM=dumb").out, Not(HasSubstr("\x1b")));
}

TEST_F(Program, ListsAndDescribesEveryPlugin) {
  const json kinds = json::parse(modcal("list --json").out);
  ASSERT_GE(kinds.size(), 8u);
  for (const json& kind : kinds) {
    const std::string name = kind["name"];
    EXPECT_THAT(modcal("list").out, HasSubstr(name));
    const json plugins = json::parse(modcal("list " + name + " --json").out);
    EXPECT_FALSE(plugins.empty()) << name;
    const std::string plugin = plugins[0]["name"];
    const std::string describe = fmt::format("describe {} {}", name, plugin);
    const json description = json::parse(modcal(describe + " --json").out);
    EXPECT_EQ(description["name"], plugin);
    EXPECT_TRUE(description["options"].is_array());
    EXPECT_EQ(modcal(describe).code, 0);
  }
  EXPECT_THAT(modcal("list dampng").err, HasSubstr("did you mean \"damping\"?"));
  EXPECT_THAT(modcal("describe damping constnt").err, HasSubstr("did you mean \"constant\"?"));
}

TEST_F(Program, ExplainsAxesByExamplesThatRun) {
  write("small.yaml", testing::kSmallSimulation);
  const json described = json::parse(modcal("describe experiment sweep --json").out);
  std::string sweep;
  for (const json& part : described["options"].back()["options"]) {
    const std::string type = part["type"];
    sweep += part["key"].get<std::string>() + ": " + type.substr(type.find("such as ") + 8) + ", ";
  }
  const Outcome plan = modcal("plan small.yaml --set 'sweep={" + sweep + "}'");
  EXPECT_EQ(plan.code, 0) << plan.err;
  // 2 x 3 of the product with 2 pairs, 2 excluded, 1 added.
  EXPECT_THAT(plan.out, HasSubstr("tasks: 11\n"));
  EXPECT_THAT(modcal("describe experiment simulate").out,
              HasSubstr("every value of one axis with every value of the others"));
}

TEST_F(Program, PrintsASchemaThatTellsRightFromWrong) {
  const std::string text = modcal("schema").out;
  EXPECT_LT(text.size(), 300'000u);  // editors read it at every key
  const testing::JsonSchema schema(json::parse(text));
  const json string = {{"length", "0.33 m"}, {"linear_density", 3.1e-3}, {"fundamental", 196}};
  json document = {{"kind", "simulate"},
                   {"title", "a string"},
                   {"scene", {{"string", string}, {"bow", {{"position", "30 mm"}}}}}};
  EXPECT_TRUE(schema.accepts(document));
  document["kind"] = "simulat";
  EXPECT_FALSE(schema.accepts(document));
  document["kind"] = "simulate";
  document["scnee"] = 1;
  EXPECT_FALSE(schema.accepts(document));
}

TEST_F(Program, ValidatesAsJson) {
  const Outcome good = modcal("validate small.yaml --json");
  EXPECT_EQ(good.code, 0);
  EXPECT_EQ(json::parse(good.out)["valid"], true);
  const Outcome bad = modcal("validate small.yaml --set seed=x --set scene.bow.positon=1 --json");
  EXPECT_EQ(bad.code, 3);
  const json report = json::parse(bad.out);
  EXPECT_EQ(report["valid"], false);
  std::size_t errors = 0;
  for (const json& mistake : report["mistakes"]) {
    if (mistake["severity"] != "error") continue;
    ++errors;
    EXPECT_THAT(mistake["place"], StartsWith("--set "));
  }
  EXPECT_EQ(errors, 2u);
}

TEST_F(Program, PlansSkipsAndPrice) {
  const json plan = json::parse(
      modcal("plan small.yaml --set scene.bow.position='33 mm' --set scene.string.modes=20 --json")
          .out);
  EXPECT_EQ(plan["kind"], "invert");
  EXPECT_EQ(plan["simulation"]["modes_moved"], 18);
  bool names_modes = false;
  for (const json& skip : plan["simulation"]["skips"]) {
    names_modes = names_modes || skip["what"] == "modes 10, 20";
    EXPECT_GE(skip["saved_seconds"], 0.0);
  }
  EXPECT_TRUE(names_modes) << plan["simulation"]["skips"];
  EXPECT_GT(plan["price"]["core_seconds"], 0.0);
}

TEST_F(Program, PlansWithoutRunning) {
  const Outcome outcome = modcal("plan small.yaml --memory 1TB --set scene.duration='3100 s'");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, Not(IsEmpty()));
  EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
}

}  // namespace
}  // namespace modcal::program_test
