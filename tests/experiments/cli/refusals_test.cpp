// Whatever a user gives: refused at once, in words, and never an internal error.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::refusals_test {
namespace {

#if defined(__has_feature)
#define MODCAL_HAS_FEATURE(name) __has_feature(name)
#else
#define MODCAL_HAS_FEATURE(name) 0
#endif
constexpr bool kAddressesAreChecked = MODCAL_HAS_FEATURE(address_sanitizer);

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class Refusals : public testing::SmallRuns {
 protected:
  // Within `seconds`, or the code is 124.
  Outcome within(int seconds, const std::string& arguments) const {
    return shell("timeout " + std::to_string(seconds) + " '" MODCAL_PROGRAM "' " + arguments);
  }
};

TEST_F(Refusals, WhatIsNoFileIsNotOpened) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  shell("mkfifo pipe.yaml pipe.csv pipe.wav; ln -s /dev/zero zero.csv; mkdir folder.yaml");
  for (const char* command :
       {"validate pipe.yaml", "validate /dev/zero", "validate folder.yaml", "inspect pipe.csv",
        "inspect pipe.wav", "inspect --format wav /dev/zero", "inspect --format csv /dev/zero",
        "inspect zero.csv", "inspect folder.yaml --format wav"}) {
    const Outcome outcome = within(20, command);
    EXPECT_EQ(outcome.code, 3) << command << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(", not a file")) << command;
  }
  for (const char* name :
       {"journal/pipe.journal", "provenance.json", "resolved.yaml", "journal/shard-1-of-1.lock"}) {
    const std::string file = std::string("a/") + name;
    for (const char* make : {"mkfifo ", "mkdir ", "ln -s /dev/zero "}) {
      shell(fmt::format("mv {0} kept; {1}{0}", file, make));
      for (const char* command : {"status a", "merge a", "report a", "run list.yaml --out a"}) {
        const Outcome outcome = within(20, command);
        EXPECT_TRUE(outcome.code == 3 || outcome.code == 0) << command << name << outcome.code;
        EXPECT_THAT(outcome.err, Not(HasSubstr("internal"))) << command << name;
      }
      shell(fmt::format("rm -rf {0}; mv kept {0}", file));
    }
  }
  EXPECT_EQ(modcal("status a").code, 0);
}

TEST_F(Refusals, ProvenanceOfWrongTypes) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  const json good = json::parse(content_of(folder() / "a/provenance.json"));
  for (const char* key : {"folder", "program", "command"}) {
    for (const json& value : {json(3), json(nullptr), json::array(), json::object()}) {
      json wrong = good;
      wrong[key] = value;
      write("a/provenance.json", wrong.dump());
      const Outcome outcome = modcal("status a");
      EXPECT_EQ(outcome.code, 3) << wrong;
      EXPECT_THAT(outcome.err, HasSubstr(std::string("a/provenance.json does not say where the "
                                                     "run came from: ") +
                                         key));
    }
  }
  for (const char* text : {"", "[]", "3", "{", "\xFF"}) {
    write("a/provenance.json", text);
    EXPECT_EQ(modcal("report a").code, 3) << text;
  }
}

TEST_F(Refusals, NamesThatAreNotUtf8) {
  const Outcome run = shell("cp small.yaml \"$(printf 'caf\\351.yaml')\"; '" MODCAL_PROGRAM
                            "' run \"$(printf 'caf\\351.yaml')\"");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("\"caf\\xe9.yaml\" is not UTF-8 text"));
  const Outcome inside =
      shell("mkdir \"$(printf 'd\\351')\"; cd \"$(printf 'd\\351')\"; '" MODCAL_PROGRAM
            "' run ../small.yaml");
  EXPECT_EQ(inside.code, 0) << inside.err;
  const Outcome here =
      shell("cd \"$(printf 'd\\351')\"; cp ../small.yaml .; '" MODCAL_PROGRAM "' run small.yaml");
  EXPECT_EQ(here.code, 3) << here.err;
  EXPECT_THAT(here.err, HasSubstr("has a name that is not UTF-8 text: rename it"));
  const Outcome journal = shell("'" MODCAL_PROGRAM
                                "' run list.yaml --out a; cp a/journal/*.journal"
                                " \"$(printf 'a/journal/\\351.journal')\"; '" MODCAL_PROGRAM
                                "' merge a && '" MODCAL_PROGRAM "' run list.yaml --out a");
  EXPECT_EQ(journal.code, 0) << journal.err;
}

TEST_F(Refusals, ColumnsNamedInLatin1AreRead) {
  std::string text = "t [s],Kraft l\xE4ngs [\xB5N],R2 [N]\n";
  for (int i = 0; i < 64; ++i) {
    text += std::to_string(i) + "e-3," + std::to_string(i * i % 7) + "," +
            std::to_string(i * i % 11) + "\n";
  }
  write("a.csv", text);
  const Outcome inspected = modcal("inspect a.csv --json");
  EXPECT_THAT(inspected.err, Not(HasSubstr("internal")));
  const json report = json::parse(inspected.out);
  EXPECT_EQ(report["channels"][0]["name"], "Kraft längs");
  EXPECT_EQ(report["channels"][0]["unit"], "µN");
  EXPECT_THAT(modcal("inspect a.csv").out, HasSubstr("Kraft längs"));
  // A field that is none.
  write("b.csv", "t [s],R1 [N]\n0,1\n1,2\xB0\n");
  EXPECT_THAT(modcal("inspect b.csv").out + modcal("inspect b.csv").err, HasSubstr("\\xb0"));
  EXPECT_EQ(json::parse(modcal("inspect b.csv --json").out)["file"], "b.csv");
}

TEST_F(Refusals, WhatNeedsMoreMemoryThanThereIs) {
  const Outcome samples = within(5, "validate small.yaml --set scene.duration=160000");
  EXPECT_EQ(samples.code, 3);
  EXPECT_THAT(samples.err, HasSubstr("the run needs about 352 GB of memory, there are "));
  EXPECT_THAT(samples.err, HasSubstr("160000 s at 12500 Hz make 2e+09 samples; shorten the "
                                     "record, lower measurement.sample_rate"));
  // What may be used can be stated, and threads that share a list count.
  EXPECT_EQ(modcal("validate small.yaml --memory 1TB --set scene.duration=160000").code, 0);
  const Outcome little = modcal("validate small.yaml --memory 100kB");
  EXPECT_EQ(little.code, 3);
  EXPECT_THAT(little.err, HasSubstr("of memory, --memory allows 100 kB"));
  EXPECT_EQ(modcal("validate small.yaml --memory 1MB").code, 0);
  EXPECT_EQ(modcal("validate small.yaml --memory nonsense").code, 2);
  // Whoever goes on with a run goes on with what it may use.
  EXPECT_EQ(modcal("run list.yaml --memory 1GB --out a").code, 0);
  EXPECT_THAT(modcal("status a --json").out, HasSubstr(" --memory 1000000000"));
  const json plan = json::parse(modcal("plan small.yaml --json").out);
  EXPECT_EQ(plan["memory_bytes"], 8 * 22 * 1250);
  EXPECT_THAT(modcal("plan small.yaml").out, HasSubstr("memory: about 220 kB of "));
  EXPECT_EQ(within(5, "run small.yaml --set scene.duration=160000").code, 3);
}

TEST_F(Refusals, LongDecaysAreJudgedByTheirSizes) {
  if (kAddressesAreChecked) GTEST_SKIP() << "its shadow memory is above any limit";
  std::string text(testing::kSmallSimulation);
  text.replace(text.find("simulate"), 8, "identify");
  text.replace(text.find("  duration"), 0,
               "  initial: {type: pluck, position: 43 mm, displacement: 1 mm, width: 3 mm}\n");
  text += "identification: {highest_frequency: 2 kHz}\n";
  write("identify.yaml", text);
  const Outcome decay = shell("ulimit -v 2000000; timeout 10 '" MODCAL_PROGRAM
                              "' validate identify.yaml --memory 1TB "
                              "--set scene.duration='20000 s'");
  EXPECT_EQ(decay.code, 0) << decay.err;
  for (const char* option : {"scene.duration", "identification.skip"}) {
    const Outcome forever =
        within(10, std::string("validate identify.yaml --set ") + option + "='1e15 s'");
    EXPECT_EQ(forever.code, 3) << forever.err;
  }
  EXPECT_EQ(within(10, "validate small.yaml --set scene.duration='1e300 s'").code, 3);
}

TEST_F(Refusals, StructuresBeyondTheMemoryAreRefusedBeforeTheirTableIsRead) {
  write("bowed.yaml", R"(kind: simulate
structure:
  table: not_there.json
  bow: {velocity: 0.1, normal_force: 5 N}
  duration: 1e4 s
measurement: {sample_rate: 100 kHz}
)");
  // Ten numbers for each of 8 steps a sample.
  for (const char* command : {"validate bowed.yaml", "plan bowed.yaml", "run bowed.yaml"}) {
    const Outcome outcome = within(5, std::string(command) + " --memory 20GB");
    EXPECT_EQ(outcome.code, 3) << command << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("bowed.yaml:5:13: error: the run needs about 640 GB of "
                                       "memory, --memory allows 20 GB, by the samples of its "
                                       "scene; state a shorter one"));
  }
  // Of a list the longest counts, for each that runs at a time.
  const Outcome list = within(5,
                              "validate bowed.yaml --memory 1TB --set "
                              "sweep='{product: {structure.duration: [1 s, 2e5 s]}}'");
  EXPECT_EQ(list.code, 3) << list.err;
  EXPECT_THAT(list.err, HasSubstr("--memory allows 1 TB, by the samples"));
}

TEST_F(Refusals, RecordsBeyondTheMemoryAreRefusedBeforeTheyAreRead) {
  std::string text = "# sample_rate: 51200 Hz\nR1 [N],R2 [N]\n";
  while (text.size() < (2 << 20)) text += "0.125,-0.5\n";
  write("long.csv", text);
  write("long.yaml", R"(kind: invert
record: {file: long.csv, left: {channel: R1}, right: {channel: R2}}
string: {length: 0.33 m, linear_density: 1e-3 kg/m, fundamental: 294 Hz, modes: 5}
bow: {position: 42 mm}
)");
  // 190 000 rows of two channels: 6 MB to read them, and 30 numbers a row to invert them.
  const Outcome stated = within(5, "validate long.yaml --memory 10MB");
  EXPECT_EQ(stated.code, 3);
  EXPECT_THAT(stated.err, HasSubstr("long.yaml:2:16: error: the run needs about 51.9 MB of memory, "
                                    "--memory allows 10 MB, by the size of its records"));
  // Four terabytes, of which the disk holds the first two megabytes.
  if (shell("truncate -s 4T long.csv").code != 0) GTEST_SKIP() << "no room for a file with holes";
  for (const char* command : {"validate long.yaml", "run long.yaml", "plan long.yaml",
                              "convert long.csv long.mat", "new invert long.csv"}) {
    const Outcome outcome = within(5, command);
    EXPECT_EQ(outcome.code, 3) << command << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("needs about ")) << command;
  }
  // Of large files inspect reads the first rows alone.
  const Outcome inspected = within(5, "inspect long.csv");
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_THAT(inspected.out, HasSubstr("R2"));
}

TEST_F(Refusals, MemoryThatIsNotThereIsNoInternalError) {
  if (kAddressesAreChecked) GTEST_SKIP() << "its shadow memory is above any limit";
  const Outcome outcome = shell("ulimit -v 600000; '" MODCAL_PROGRAM
                                "' run small.yaml --memory 1TB --set scene.duration='2000 s' --set "
                                "simulator='{type: modal_exact, time_step: 80 us}' --out a");
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("modcal run small.yaml --memory 1TB"));
  EXPECT_THAT(outcome.err, HasSubstr("does not suffice; shorten the record"));
}

TEST_F(Refusals, APlanTakesItsSecondHoweverLongTheRunWould) {
  for (const char* file : {"small.yaml", "list.yaml"}) {
    const Outcome plan =
        within(60, std::string("plan ") + file + " --json --set simulator.time_step='1e-12 s'");
    EXPECT_EQ(plan.code, 0) << file << plan.err;
    const json object = json::parse(plan.out);
    // Ten times the steps take ten times as long, whatever was tried out.
    EXPECT_GT(object["price"]["core_seconds"], 100.0) << file;
    EXPECT_NEAR(object["simulation"]["longest_step"], 1e-12, 1e-15);
    EXPECT_EQ(object["simulation"]["samples"], 1250);
  }
}

TEST_F(Refusals, ParsingAndValidationEndAtOnceWhenAsked) {
  // A list of lists that takes seconds to read.
  std::string text = testing::kSmallSimulation + "figures: [";
  for (int i = 0; i < 400000; ++i) text += "{id: a, quantities: [y]}, ";
  write("long.yaml", text + "]\n");
  for (const char* signal : {"INT", "TERM"}) {
    const Outcome outcome = shell(std::string("timeout --foreground -k 2 -s ") + signal +
                                  " 0.2 '" MODCAL_PROGRAM "' validate long.yaml");
    // 124: timeout's own code for a program that ended when it was told to; 137: it had to kill.
    EXPECT_EQ(outcome.code, 124) << outcome.code;
  }
  const Outcome code = shell("'" MODCAL_PROGRAM
                             "' validate long.yaml & sleep 0.2; kill -TERM $!; "
                             "wait $!");
  EXPECT_EQ(code.code, 130);
}

TEST_F(Refusals, WordsThatTheCommandLineDoesNotKnow) {
  const auto refuses = [&](const std::string& words, int code, const std::string& text) {
    const Outcome outcome = modcal(words);
    EXPECT_EQ(outcome.code, code) << words;
    EXPECT_THAT(outcome.err, HasSubstr(text)) << words;
  };
  refuses("run --ouput x small.yaml", 2, "unknown option \"--ouput\"; did you mean \"--out\"?");
  refuses("run small.yaml --otu=b", 2, "unknown option \"--otu\"; did you mean \"--out\"?");
  refuses("run --threds 2", 2, "did you mean \"--threads\"?");
  refuses("run small.yaml -o b", 2, "unknown option \"-o\"; known: --help");
  refuses("small.yaml run", 2, "the command comes first: modcal run small.yaml");
  refuses("rum small.yaml", 2, "did you mean \"run\"?");
  refuses("run small.yaml --out ''", 2, "--out: the name is empty");
  refuses("new invert --out ''", 2, "--out: the name is empty");
  refuses("replay a -1", 2, "\"-1\" is no task: they are numbered 0, 1, 2");
  refuses("replay a x", 2, "\"x\" is no task");
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(Refusals, LongLinesAreShownInPart) {
  const auto shown = [&](const std::string& text) {
    write("long.yaml", text);
    const Outcome outcome = modcal("validate long.yaml");
    EXPECT_EQ(outcome.code, 3);
    return outcome.err;
  };
  const std::string deep = shown(std::string(100'000, '['));
  EXPECT_LT(deep.size(), 500u);
  EXPECT_THAT(deep, HasSubstr("nested too deeply"));
  EXPECT_LT(shown("kind: simulate\nscene: " + std::string(100'000, '{')).size(), 500u);
  EXPECT_LT(shown("kind: " + std::string(1'000'000, 'x')).size(), 5000u);
  // The caret stands below its place, between characters of several bytes, too.
  std::string far =
      "kind: simulate\n"
      "note: {";
  for (int i = 0; i < 300; ++i) far += "\xC3\xA4: 1, ";
  const std::string message = shown(far + "& }\n");
  std::istringstream lines(message);
  std::string place, line, caret;
  std::getline(lines, place);
  std::getline(lines, line);
  std::getline(lines, caret);
  EXPECT_LT(line.size(), 300u);
  EXPECT_EQ(caret.find_first_not_of(' '), caret.size() - 1);
}

TEST_F(Refusals, NumbersThatAreTooLarge) {
  const auto said = [&](const std::string& assignment) {
    const Outcome outcome = modcal("validate small.yaml --set " + assignment);
    EXPECT_EQ(outcome.code, 3) << assignment;
    return outcome.err;
  };
  EXPECT_THAT(said("scene.string.modes=100000000000000000000"),
              HasSubstr("the number is too large; it must be in [1, 5000]"));
  EXPECT_THAT(said("seed=100000000000000000000"),
              HasSubstr("the number is too large; it must be >= 0, 9223372036854775807 at most"));
  EXPECT_THAT(said("seed=-100000000000000000000"), HasSubstr("the number is too small"));
}

}  // namespace
}  // namespace modcal::refusals_test
