// What earlier runs, other programs and other people have left in a folder of results.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "experiments/runs/journal.hpp"
#include "tests/experiments/cli/program_run.hpp"

namespace modcal::leftovers_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class Leftovers : public testing::SmallRuns {
 protected:
  static constexpr const char* kJournal = "a/journal/shard-1-of-1.journal";

  bool has_parts() const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder())) {
      if (entry.path().extension() == ".part") return true;
    }
    return false;
  }
};

TEST_F(Leftovers, ADamagedLineIsNamedUntilItsTaskWasDoneAgain) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  std::string journal = content_of(folder() / kJournal);
  journal[journal.size() / 2] ^= 1;
  write(kJournal, journal);
  EXPECT_THAT(modcal("status a").err, HasSubstr("does not match its checksum"));
  EXPECT_THAT(modcal("run list.yaml --out a").err, HasSubstr("its task will be run again"));
  for (const char* command : {"run list.yaml --out a", "status a", "merge a", "report a"}) {
    const Outcome outcome = modcal(command);
    EXPECT_EQ(outcome.code, 0) << command;
    EXPECT_THAT(outcome.err, Not(HasSubstr("checksum"))) << command;
  }
  EXPECT_EQ(json::parse(modcal("status a --json").out)["damaged_lines"], 0);
  // Of another shard, too, once the whole list was run.
  ASSERT_EQ(
      modcal("run list.yaml --out a --shard 2/4 --set seed=9 --set scene.duration='0.2 s'").code,
      0);
  std::string other = content_of(folder() / "a/journal/shard-2-of-4.journal");
  other[other.size() / 2] ^= 1;
  write("a/journal/shard-2-of-4.journal", other);
  EXPECT_THAT(modcal("run list.yaml --out a").err, HasSubstr("shard-2-of-4.journal: line 2"));
  EXPECT_THAT(modcal("run list.yaml --out a").err, Not(HasSubstr("checksum")));
}

TEST_F(Leftovers, AForgedOutcomeIsNamedWithFileAndLine) {
  for (const char* forged :
       {R"({"failure":1})", "[]", "3", R"({"failure":"","numbers":[3]})", "no JSON", "{}"}) {
    ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
    std::istringstream lines(content_of(folder() / kJournal));
    std::string text, line;
    for (int number = 1; std::getline(lines, line); ++number) {
      if (number == 3) {
        // "checksum key task seconds outcome"
        const std::size_t outcome = line.find(" {");
        const std::string content = line.substr(17, outcome - 17) + " " + forged;
        line = checksum_of(content) + " " + content;
      }
      text += line + "\n";
    }
    write(kJournal, text);
    for (const char* command : {"run list.yaml --out a", "report a", "status a", "merge a"}) {
      const Outcome outcome = modcal(command);
      EXPECT_TRUE(outcome.code == 3 || (outcome.code == 0 && forged[0] == '{')) << command;
      if (outcome.code == 0) continue;
      EXPECT_THAT(outcome.err, HasSubstr(std::string(kJournal) + ": line 3: ")) << command;
      EXPECT_THAT(outcome.err, HasSubstr("delete the line, and its task is run again"));
    }
    shell("sed -i 3d a/journal/shard-1-of-1.journal");
    EXPECT_EQ(modcal("run list.yaml --out a").code, 0) << forged;
    shell("rm -r a");
  }
}

TEST_F(Leftovers, HalfWrittenFilesOfKilledRunsAreRemoved) {
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  shell(
      "touch -d '1 hour ago' a/report.html.4711.part a/levels.csv.0badcafe.part "
      "a/figures.4711.part a/results.sqlite.99.part; mkdir -p a/figures; "
      "touch -d '1 hour ago' a/figures/x.csv.12.part");
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  EXPECT_FALSE(has_parts());
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  shell("touch -d '1 hour ago' a/results.sqlite.4711.part");
  ASSERT_EQ(modcal("merge a").code, 0);
  EXPECT_FALSE(has_parts());
}

TEST_F(Leftovers, LinksOfOthersAreNotWrittenThrough) {
  write("victim", "kept\n");
  std::filesystem::create_directories(folder() / "a/journal");
  const auto refuses = [&](const std::string& name, const std::string& how) {
    shell("ln -f " + how + " \"$PWD\"/victim a/" + name);
    Outcome outcome = modcal("run list.yaml --out a");
    EXPECT_EQ(content_of(folder() / "victim"), "kept\n") << name << how;
    shell("rm -f a/" + name);
    return outcome;
  };
  for (const char* name :
       {"journal/shard-1-of-1.journal", "journal/shard-1-of-1.lock", "journal/run.lock"}) {
    const Outcome symbolic = refuses(name, "-s");
    EXPECT_EQ(symbolic.code, 3) << name;
    EXPECT_THAT(symbolic.err, HasSubstr("is a link, not a file")) << name;
    const Outcome hard = refuses(name, "");
    EXPECT_EQ(hard.code, 3) << name;
    EXPECT_THAT(hard.err, HasSubstr("a hard link")) << name;
  }
  for (const char* how : {"-s", ""}) {
    EXPECT_EQ(refuses(".modcal-write-test", how).code, 0);
    EXPECT_EQ(refuses("report.html", how).code, 0);
    EXPECT_EQ(refuses("provenance.json", how).code, 0);
  }
  // A full device in the place of the journal, as a link can put it there.
  shell("rm -r a; mkdir -p a/journal; ln -s /dev/full a/journal/shard-1-of-1.journal");
  EXPECT_EQ(modcal("run list.yaml --out a").code, 3);
}

TEST_F(Leftovers, FoldersOfOthersAreNotWrittenTo) {
  write("drawn.yaml", testing::kSmallSimulation + "figures: [{id: fig1, quantities: [y, R1]}]\n");
  std::filesystem::create_directories(folder() / "elsewhere");
  for (const auto& [file, place] :
       {std::pair{"list.yaml", "journal"}, std::pair{"drawn.yaml", "figures"}}) {
    shell("rm -rf a; mkdir a; ln -s ../elsewhere a/" + std::string(place));
    const Outcome outcome = modcal("run " + std::string(file) + " --out a");
    EXPECT_EQ(outcome.code, 3) << place;
    EXPECT_THAT(outcome.err, HasSubstr("is a link, not a folder")) << place;
    EXPECT_TRUE(std::filesystem::is_empty(folder() / "elsewhere")) << place;
  }
}

TEST_F(Leftovers, WhatIsDrawnGoesToNewFiles) {
  write("drawn.yaml", testing::kSmallSimulation + "figures: [{id: fig1, quantities: [y, R1]}]\n");
  write("victim", "kept\n");
  std::filesystem::create_directories(folder() / "a/figures");
  for (const char* how : {"-s", ""}) {
    for (const char* name : {"fig1.svg.part", "fig1.pdf.part", "fig1.svg", "fig1.pdf"}) {
      shell(std::string("ln -f ") + how + " \"$PWD\"/victim a/figures/" + name);
      modcal("run drawn.yaml --out a");
      EXPECT_EQ(content_of(folder() / "victim"), "kept\n") << name << how;
      shell("rm -f a/figures/" + std::string(name));
    }
  }
}

TEST_F(Leftovers, AForgedListOfFoldersRemovesNothingOfThisRun) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  for (const char* folders : {"[\"\"]", "\"\"", "[\".\"]"}) {
    std::string text = content_of(folder() / "a/provenance.json");
    text.insert(text.find('{') + 1, std::string("\"folders\": ") + folders + ",");
    write("a/provenance.json", text);
    EXPECT_EQ(modcal("report a").code, 0) << folders;
    EXPECT_TRUE(std::filesystem::exists(folder() / "a/report.html")) << folders;
    EXPECT_TRUE(std::filesystem::exists(folder() / "a/resolved.yaml")) << folders;
  }
}

TEST_F(Leftovers, TablesHoldNoFormulas) {
  shell(
      "awk 'BEGIN {srand(1); print \"# sample_rate: 44100 Hz\\n=cmd|x [N],@SUM(1) [N],-1 [N]\"; "
      "for (i = 0; i < 9000; ++i) {r = sin(0.04189*i) + sin(0.12567*i) + 0.01*rand(); "
      "print r \",\" r \",\" r}}' > r.csv");
  write("formula.yaml", R"yaml(kind: invert
record: {file: r.csv, left: {channel: -1}}
string: {length: 0.33 m, linear_density: 1e-3 kg/m, fundamental: 294 Hz, modes: 10}
bow: {position: 41 mm}
sweep: {product: {record.left.channel: ["=cmd|x", "@SUM(1)", "-1"]}}
)yaml");
  const Outcome run = modcal("run formula.yaml --out a");
  ASSERT_EQ(run.code, 0) << run.err;
  const std::string table = content_of(folder() / "a/tasks.csv");
  EXPECT_THAT(table, HasSubstr(",'=cmd|"));
  EXPECT_THAT(table, HasSubstr(",'@SUM"));
  EXPECT_THAT(table, HasSubstr(",-1,"));
  EXPECT_THAT(table, Not(HasSubstr(",=cmd")));
}

TEST_F(Leftovers, NamesReachNoTerminalRaw) {
  const std::string name = "evil\033[2J\r.yaml";
  write(name, testing::kSmallSimulation);
  const Outcome valid = modcal("validate \"$(printf 'evil\\033[2J\\r.yaml')\"");
  EXPECT_EQ(valid.code, 0) << valid.err;
  EXPECT_EQ(valid.out, "evil\\x1b[2J\\x0d.yaml: valid, kind simulate\n");
  const Outcome wrong =
      modcal("run \"$(printf 'evil\\033[2J\\r.yaml')\" --set \"$(printf 'ti\\033[31mtle=1')\"");
  EXPECT_EQ(wrong.code, 3);
  EXPECT_THAT(wrong.err, HasSubstr("\\x1b[31m"));
  EXPECT_THAT(wrong.err + wrong.out, Not(HasSubstr("\033")));
  write("title.yaml", "kind: simulate\ntitle: \"a\\e[31mb\"\nnonsense\\e: 1\n");
  EXPECT_THAT(modcal("validate title.yaml").err, Not(HasSubstr("\033")));
}

TEST_F(Leftovers, AFileOfDotsGetsAFolderOfItsOwn) {
  write("...yaml", testing::kSmallSimulation);
  EXPECT_EQ(modcal("run ...yaml").code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder() / "out/...yaml/report.html"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "report.html"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "out/report.html"));
}

TEST_F(Leftovers, NothingIsLeftOfAnInterruptedConversion) {
  shell(
      "awk 'BEGIN {print \"# sample_rate: 1000 Hz\\nR1 [N],R2 [N]\"; for (i = 0; i < 1000000; ++i) "
      "print i % 7 \",\" i % 11}' > large.csv");
  const Outcome ended = shell("'" MODCAL_PROGRAM
                              "' convert large.csv other.csv & until ls | grep -q part; do kill -0 "
                              "$! || exit 99; done; kill -TERM $!; wait $!");
  EXPECT_EQ(ended.code, 130) << ended.out << ended.err;
  EXPECT_FALSE(has_parts());
  EXPECT_FALSE(std::filesystem::exists(folder() / "other.csv"));
}

}  // namespace
}  // namespace modcal::leftovers_test
