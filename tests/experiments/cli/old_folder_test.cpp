// A run in the folder of an earlier one: what stands there is of one run, and files of others stay.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::old_folder_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

class OldFolder : public testing::SmallRuns {
 protected:
  OldFolder() {
    std::string invert(testing::kSmallSimulation);
    invert.replace(invert.find("simulate"), 8, "invert");
    write("invert.yaml", invert);
  }

  // All files below a folder but those of the journal.
  std::set<std::string> files_in(const std::string& name) const {
    std::set<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path(name))) {
      const std::string file = std::filesystem::relative(entry.path(), path(name)).string();
      if (entry.is_regular_file() && !file.starts_with("journal/")) files.insert(file);
    }
    return files;
  }
  std::set<std::string> listed_in(const std::string& name) const {
    return json::parse(content_of(path(name) / "provenance.json"))["files"];
  }
};

TEST_F(OldFolder, HoldsTheFilesOfTheLastRunAlone) {
  const std::vector<std::string> kinds = {"small", "invert", "list"};
  for (const std::string& kind : kinds) {
    ASSERT_EQ(modcal(fmt::format("run {0}.yaml --out fresh/{0}", kind)).code, 0) << kind;
  }
  for (const char* kind : {"small", "invert", "list", "invert", "small"}) {
    const std::string name = kind;
    ASSERT_EQ(modcal("run " + name + ".yaml --out a").code, 0) << name;
    EXPECT_EQ(files_in("a"), files_in("fresh/" + name)) << name;
    for (const std::string& file : files_in("a")) EXPECT_TRUE(listed_in("a").contains(file));
    EXPECT_EQ(content_of(path("a/resolved.yaml")),
              content_of(path("fresh/" + name + "/resolved.yaml")));
  }
}

TEST_F(OldFolder, KeepsTheJournalAndTheDatabaseOfItsList) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  ASSERT_EQ(modcal("merge a").code, 0);
  ASSERT_EQ(modcal("report a").code, 0);
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  EXPECT_TRUE(files_in("a").contains("results.sqlite"));
  ASSERT_EQ(modcal("run list.yaml --out a --set seed=9 --set scene.duration='0.2 s'").code, 0);
  EXPECT_FALSE(files_in("a").contains("results.sqlite"));
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  EXPECT_TRUE(std::filesystem::exists(path("a/journal/shard-1-of-1.journal")));
}

TEST_F(OldFolder, OfSomebodyElseIsRefusedBeforeAnythingIsComputed) {
  for (const char* file : {"report.html", "resolved.yaml", "provenance.json"}) {
    std::filesystem::create_directories(path("a"));
    write(std::string("a/") + file, "mine\n");
    for (const char* run : {"small", "list"}) {
      const Outcome outcome = modcal(std::string("run ") + run + ".yaml --out a");
      EXPECT_EQ(outcome.code, 3) << file;
      EXPECT_THAT(outcome.err, HasSubstr(std::string("a/") + file + ": no run of modcal wrote"));
      EXPECT_THAT(outcome.err, HasSubstr("--out"));
      EXPECT_EQ(content_of(path(std::string("a/") + file)), "mine\n");
      EXPECT_EQ(files_in("a"), std::set<std::string>{file});
    }
    std::filesystem::remove_all(path("a"));
  }
}

TEST_F(OldFolder, KeepsAFileInTheWayOfATableAndTheResults) {
  std::filesystem::create_directories(path("a/figures"));
  write("a/levels.csv", "mine\n");
  write("a/notes.csv", "mine, too\n");
  const Outcome outcome = modcal("run small.yaml --out a");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("a/levels.csv: no run of modcal wrote this file"));
  EXPECT_EQ(content_of(path("a/levels.csv")), "mine\n");
  EXPECT_THAT(content_of(path("a/results/levels.csv")), HasSubstr("R1"));
  EXPECT_TRUE(std::filesystem::exists(path("a/results/report.html")));
  std::filesystem::remove(path("a/levels.csv"));
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  EXPECT_EQ(content_of(path("a/notes.csv")), "mine, too\n");
}

TEST_F(OldFolder, WhoseListOfFilesIsForgedLosesNothingElse) {
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  json provenance = json::parse(content_of(path("a/provenance.json")));
  write("victim", "kept\n");
  std::filesystem::create_directories(path("other"));
  write("other/victim", "kept\n");
  std::filesystem::create_directory_symlink(path("other"), path("a/links"));
  for (const std::string& name : {std::string("../victim"), path("victim").string(),
                                  std::string("links/victim"), std::string("links/../../victim"),
                                  std::string("."), std::string(".."), std::string("journal")}) {
    provenance["files"].push_back(name);
  }
  provenance["files"].push_back(3);
  write("a/provenance.json", provenance.dump());
  EXPECT_EQ(modcal("run small.yaml --out a").code, 0);
  EXPECT_EQ(content_of(path("victim")), "kept\n");
  EXPECT_EQ(content_of(path("other/victim")), "kept\n");
}

// A part of a list leaves what an interrupted one leaves: settings and a journal.
TEST_F(OldFolder, HoldsNoResultsOfOthersWhileAListIsNotDone) {
  const std::set<std::string> settings = {"notes.txt", "provenance.json", "resolved.yaml"};
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  write("a/notes.txt", "mine\n");
  ASSERT_EQ(modcal("run list.yaml --out a --shard 1/2").code, 0);
  EXPECT_EQ(files_in("a"), settings);
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  ASSERT_EQ(modcal("merge a").code, 0);
  const std::set<std::string> whole = files_in("a");
  // The same list keeps what it has, of the same program.
  ASSERT_EQ(modcal("run list.yaml --out a --shard 1/2").code, 0);
  EXPECT_EQ(files_in("a"), whole);
  json provenance = json::parse(content_of(path("a/provenance.json")));
  provenance["program"] = "modcal of yesterday";
  write("a/provenance.json", provenance.dump());
  ASSERT_EQ(modcal("run list.yaml --out a --shard 1/2").code, 0);
  EXPECT_EQ(files_in("a"), settings);
}

TEST_F(OldFolder, WithAFileInTheWayOfAListIsRefusedBeforeATaskIsRun) {
  std::filesystem::create_directories(path("a"));
  write("a/tasks.csv", "mine\n");
  const Outcome outcome = modcal("run list.yaml --out a");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("a/tasks.csv: no run of modcal wrote this file"));
  EXPECT_EQ(files_in("a"), std::set<std::string>{"tasks.csv"});
  EXPECT_EQ(content_of(path("a/tasks.csv")), "mine\n");
}

TEST_F(OldFolder, LosesTheExperimentsThatAReproductionNoLongerHas) {
  std::filesystem::create_directories(path("configs/paper"));
  for (const char* name : {"one", "two", "three"}) {
    write(std::string("configs/paper/") + name + ".yaml", testing::kSmallSimulation);
  }
  const auto reproduce = [this] {
    return modcal("reproduce paper --configs configs --out a").code;
  };
  ASSERT_EQ(reproduce(), 0);
  write("a/three/notes.txt", "mine\n");
  std::filesystem::remove(path("configs/paper/two.yaml"));
  std::filesystem::remove(path("configs/paper/three.yaml"));
  write("configs/paper/four.yaml", testing::kSmallSimulation);
  ASSERT_EQ(reproduce(), 0);
  EXPECT_TRUE(std::filesystem::exists(path("a/one/resolved.yaml")));
  EXPECT_FALSE(std::filesystem::exists(path("a/two")));
  EXPECT_EQ(files_in("a/three"), std::set<std::string>{"notes.txt"});
  EXPECT_TRUE(std::filesystem::exists(path("a/four/resolved.yaml")));
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("a/one")));
}

TEST_F(OldFolder, KeepsScriptsThatSubmitDidNotWrite) {
  const std::string submit = "submit list.yaml --slurm --dry-run --out a";
  write("list.yaml", testing::kSmallSimulation + testing::many_seeds(50));
  std::filesystem::create_directories(path("a/slurm"));
  write("a/slurm/merge.sh", "mine\n");
  const Outcome outcome = modcal(submit);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("a/slurm/merge.sh: no run of modcal wrote this file"));
  EXPECT_EQ(files_in("a"), std::set<std::string>{"slurm/merge.sh"});
  std::filesystem::remove(path("a/slurm/merge.sh"));
  ASSERT_EQ(modcal(submit).code, 0);
  const std::string other = " --set scene.duration='0.2 s'";
  ASSERT_EQ(modcal(submit + other).code, 0);  // its own are replaced
  EXPECT_THAT(content_of(path("a/slurm/run.sh")), HasSubstr("0.2 s"));
  ASSERT_EQ(modcal("run list.yaml --out a" + other).code, 0);
  EXPECT_TRUE(files_in("a").contains("slurm/run.sh"));
  ASSERT_EQ(modcal("run small.yaml --out a").code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("a/slurm")));
}

TEST_F(OldFolder, KeepsScriptsThatNoCommandWrote) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);  // its database and scripts would stay
  std::filesystem::create_directories(path("a/slurm"));
  write("a/slurm/run.sh", "mine\n");
  ASSERT_EQ(modcal("run list.yaml --out a --set scene.duration='0.2 s'").code, 0);
  EXPECT_EQ(content_of(path("a/slurm/run.sh")), "mine\n");
}

TEST_F(OldFolder, WithoutAFinishedTaskIsNotMerged) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  ASSERT_EQ(modcal("merge a").code, 0);
  const std::string database = content_of(path("a/results.sqlite"));
  write("a/journal/shard-1-of-1.journal", "");
  for (const char* command : {"merge a", "report a"}) {
    const Outcome outcome = modcal(command);
    EXPECT_EQ(outcome.code, 3) << command;
    EXPECT_THAT(outcome.err, HasSubstr("tasks is done, by this program and with its files"));
  }
  EXPECT_EQ(content_of(path("a/results.sqlite")), database);
  EXPECT_THAT(modcal("replay a 0").err,
              HasSubstr("task 0 of a: by this program and with the files"));
}

}  // namespace
}  // namespace modcal::old_folder_test
