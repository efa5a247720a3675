// Lists of tasks from outside: killed, resumed, shared out, asked about.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <random>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::resume_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kSweep = "kind: sweep\ntitle: small sweep\n" + testing::kSmallScene +
                           R"(measurement: {sample_rate: 12.5 kHz}
inversion: {estimator: one_sided, regularizer: {type: water_level}, parameter_choice: {type: minimal_product}}
score: {windows: [50 ms], periods: 2}
sweep:
  product:
    scene.bow.normal_force: [0.98 N, 1 N]
    measurement.noise_level: [0 %, 1 %, 2 %, 5 %]
    seed: [1, 2, 3, 4, 5]
)";
constexpr int kTasks = 40;

class Resume : public testing::ProgramTest {
 protected:
  Resume() { write("sweep.yaml", kSweep); }

  std::string tables_of(const std::string& out) const {
    return content_of(folder() / out / "tasks.csv") + content_of(folder() / out / "table.csv") +
           content_of(folder() / out / "table.json");
  }
  // What is left of "…: 40 of 40 tasks, digest 0123…".
  std::string digest_of(const std::string& out) const {
    const Outcome merged = modcal("merge " + out);
    EXPECT_EQ(merged.code, 0) << merged.err;
    return merged.out.substr(merged.out.find(':'));
  }
};

TEST_F(Resume, GivesTheSameBytesAfterTwoHundredKills) {
  ASSERT_EQ(modcal("run sweep.yaml --out whole").code, 0);
  const std::string tables = tables_of("whole");
  const std::string digest = digest_of("whole");
  ASSERT_FALSE(tables.empty());
  std::mt19937 random(1);
  // From the first read of a file to the last write of a report.
  std::uniform_real_distribution<double> seconds(0.001, 0.06);
  int kills = 0;
  for (int round = 0; kills < 200; ++round) {
    const std::string out = "killed" + std::to_string(round);
    for (int attempt = 0; attempt < 12 && kills < 200; ++attempt) {
      const Outcome outcome =
          shell("timeout --foreground -s KILL " + std::to_string(seconds(random)) +
                " '" MODCAL_PROGRAM "' run sweep.yaml --threads 2 --out " + out);
      // 124: it ended by itself in the instant in which its time was up.
      if (outcome.code == 0 || outcome.code == 124) break;
      ASSERT_EQ(outcome.code, 137) << outcome.err;
      ++kills;
    }
    const Outcome resumed = modcal("run sweep.yaml --out " + out);
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    ASSERT_EQ(tables_of(out), tables);
    ASSERT_EQ(digest_of(out), digest);
    std::filesystem::remove_all(folder() / out);
  }
}

TEST_F(Resume, RepeatsNothingThatIsFinished) {
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  const std::string journal = content_of(folder() / "a/journal/shard-1-of-1.journal");
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  EXPECT_EQ(content_of(folder() / "a/journal/shard-1-of-1.journal"), journal);
  // A changed list repeats what it has in common neither.
  ASSERT_EQ(modcal("run sweep.yaml --out a --set sweep.product.seed='[5, 6]'").code, 0);
  const std::string longer = content_of(folder() / "a/journal/shard-1-of-1.journal");
  EXPECT_EQ(std::count(longer.begin(), longer.end(), '\n'),
            std::count(journal.begin(), journal.end(), '\n') + 8);
}

TEST_F(Resume, ShardsGiveTheTableOfTheWhole) {
  ASSERT_EQ(modcal("run sweep.yaml --out whole").code, 0);
  for (int shard = 1; shard <= 7; ++shard) {
    const Outcome outcome =
        modcal("run sweep.yaml --out parts --shard " + std::to_string(shard) + "/7");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("modcal report parts"));
    EXPECT_FALSE(std::filesystem::exists(folder() / "parts/report.html"));
  }
  EXPECT_THAT(modcal("run sweep.yaml --out 'in two' --shard 1/2").out,
              HasSubstr("modcal report 'in two'\n"));
  ASSERT_EQ(modcal("report parts").code, 0);
  EXPECT_EQ(tables_of("parts"), tables_of("whole"));
  EXPECT_EQ(digest_of("parts"), digest_of("whole"));
}

TEST_F(Resume, SaysHowFarARunIsAndReportsWhatThereIs) {
  ASSERT_EQ(modcal("run sweep.yaml --out part --shard 2/4").code, 0);
  const Outcome status = modcal("status part --json");
  ASSERT_EQ(status.code, 0) << status.err;
  const json counts = json::parse(status.out);
  EXPECT_EQ(counts["tasks"], kTasks);
  EXPECT_EQ(counts["done"], kTasks / 4);
  EXPECT_EQ(counts["pending"], kTasks - kTasks / 4);
  EXPECT_EQ(counts["running"], false);
  EXPECT_THAT(modcal("status part").out,
              HasSubstr("go on with:\n  modcal run sweep.yaml --out part"));
  const Outcome below = shell("mkdir below; cd below; '" MODCAL_PROGRAM "' status ../part");
  EXPECT_THAT(below.out, HasSubstr("go on with:\n  cd " + folder().string() +
                                   " && modcal run sweep.yaml --out part\n"));
  // Nor does a report from there make them paths from there.
  ASSERT_EQ(shell("cd below; '" MODCAL_PROGRAM "' report ../part").code, 0);
  EXPECT_THAT(shell("cd below; '" MODCAL_PROGRAM "' status ../part").out,
              HasSubstr(" && modcal run sweep.yaml --out part\n"));
  ASSERT_EQ(modcal("report part").code, 0);
  EXPECT_THAT(content_of(folder() / "part/report.html"), HasSubstr("10 of 40 tasks done"));
}

TEST_F(Resume, ReadsARunFromAnotherFolderThanItWasMadeIn) {
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  EXPECT_EQ(
      shell("mkdir elsewhere && mv a elsewhere/b && cd elsewhere && '" MODCAL_PROGRAM "' report b")
          .code,
      0);
}

TEST_F(Resume, ReplaysOneTaskWithEverythingDrawn) {
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  const Outcome replayed = modcal("replay a 7");
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_THAT(replayed.err, HasSubstr("measurement.noise_level: 1 %\nseed: 3\n"));
  for (const char* name : {"report.html", "identified.csv", "identification.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder() / "a/replay/task-7" / name)) << name;
  }
  // The same scores as in the table of tasks.
  const json rows = json::parse(content_of(folder() / "a/replay/task-7/identification.json"));
  EXPECT_THAT(content_of(folder() / "a/tasks.csv"),
              HasSubstr(rows[0]["correlation"].dump().substr(0, 12)));
  const Outcome beyond = modcal("replay a 40");
  EXPECT_EQ(beyond.code, 3);
  EXPECT_THAT(beyond.err, HasSubstr("task 40 does not exist: a has the tasks 0 to 39"));
}

TEST_F(Resume, NamesADamagedLineAndRunsItsTaskAgain) {
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  const std::string tables = tables_of("a");
  const std::filesystem::path file = folder() / "a/journal/shard-1-of-1.journal";
  std::string journal = content_of(file);
  journal[journal.size() / 2] ^= 1;
  write("a/journal/shard-1-of-1.journal", journal);
  EXPECT_THAT(modcal("status a").err, HasSubstr("does not match its checksum"));
  const Outcome again = modcal("run sweep.yaml --out a");
  ASSERT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("its task will be run again"));
  EXPECT_EQ(tables_of("a"), tables);
}

TEST_F(Resume, ComparesTwoRunsOnTheTasksTheyShare) {
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  ASSERT_EQ(modcal("run sweep.yaml --out b --set inversion.regularizer=none "
                   "--set sweep.product.seed='[1, 2, 3]'")
                .code,
            0);
  const Outcome outcome = modcal("compare a b");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("24 of 40 and 24 tasks in common"));
  EXPECT_THAT(outcome.out, HasSubstr("a is better"));
  EXPECT_THAT(modcal("compare a a").out, HasSubstr("the two cannot be told apart"));
}

// Everything a list can do, of a kind that is none without its axes.
TEST_F(Resume, MakesAListOfAnyKind) {
  std::string text(kSweep);
  text.replace(text.find("sweep"), 5, "simulate");
  for (const char* line : {"inversion:", "score:"}) {
    const std::size_t start = text.find(line);
    text.erase(start, text.find('\n', start) + 1 - start);
  }
  text.replace(text.find("[1, 2, 3, 4, 5]"), 15, "[1, 2]");
  write("list.yaml", text);
  ASSERT_EQ(modcal("run list.yaml --out a --shard 1/2").code, 0);
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  const std::string journal = content_of(folder() / "a/journal/shard-1-of-1.journal");
  EXPECT_EQ(std::count(journal.begin(), journal.end(), '\n'), 1 + 8);
  ASSERT_EQ(modcal("run list.yaml --out whole").code, 0);
  EXPECT_EQ(content_of(folder() / "a/tasks.csv"), content_of(folder() / "whole/tasks.csv"));
  EXPECT_EQ(digest_of("a"), digest_of("whole"));
  const Outcome replayed = modcal("replay a 3");
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_THAT(replayed.err, HasSubstr("measurement.noise_level: 1 %\nseed: 2\n"));
  EXPECT_TRUE(std::filesystem::exists(folder() / "a/replay/task-3/levels.csv"));
  EXPECT_THAT(modcal("compare a whole").err, HasSubstr("name one with --number"));
  const Outcome compared = modcal("compare a whole --number levels.R1.std");
  EXPECT_THAT(compared.out, HasSubstr("16 of 16 and 16 tasks in common\nlevels.R1.std: median"));
  EXPECT_EQ(modcal("compare a whole --number levels.R3.std").code, 3);
}

TEST_F(Resume, RefusesFoldersWithoutARun) {
  for (const char* command : {"status", "merge", "report", "replay"}) {
    const Outcome outcome =
        modcal(std::string(command) + " nowhere" + (command == std::string("replay") ? " 0" : ""));
    EXPECT_EQ(outcome.code, 3) << command;
    EXPECT_THAT(outcome.out, IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr("nowhere holds no run"));
  }
}

TEST_F(Resume, KeepsWhatIsFinishedWhereTheDiskIsFull) {
  // The journal may grow to 8 kB (16 blocks): some of the tasks.
  const Outcome full =
      shell("trap '' XFSZ; ulimit -f 16; '" MODCAL_PROGRAM "' run sweep.yaml --threads 1 --out a");
  EXPECT_EQ(full.code, 3);
  EXPECT_THAT(full.err, HasSubstr("the journal cannot be written"));
  EXPECT_THAT(full.err, HasSubstr("run the same command again"));
  const json counts = json::parse(modcal("status a --json").out);
  EXPECT_GT(counts["done"], 0);
  EXPECT_LT(counts["done"], kTasks);
  EXPECT_EQ(counts["damaged_lines"], 0);
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  ASSERT_EQ(modcal("run sweep.yaml --out whole").code, 0);
  EXPECT_EQ(tables_of("a"), tables_of("whole"));
}

// Every place at which a full disk can meet a run: settings, journal, tables, report.
TEST_F(Resume, SaysThatTheDiskIsFullWhereverItMeetsIt) {
  ASSERT_EQ(modcal("run sweep.yaml --out whole").code, 0);
  ASSERT_EQ(modcal("run sweep.yaml --out a --shard 1/2").code, 0);
  const std::string half = content_of(folder() / "a/journal/shard-1-of-2.journal");
  for (const char* blocks : {"0", "2", "6", "16", "60", "200"}) {
    const Outcome full =
        shell(std::string("( trap '' XFSZ; ulimit -f ") + blocks +
              "; '" MODCAL_PROGRAM "' run sweep.yaml --out a 2>&1; echo \"code $?\" ) | cat");
    EXPECT_THAT(full.out, HasSubstr("File too large")) << blocks;
    EXPECT_THAT(full.out, HasSubstr("code 3\n")) << blocks;
    EXPECT_EQ(content_of(folder() / "a/journal/shard-1-of-2.journal"), half);
  }
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  EXPECT_EQ(tables_of("a"), tables_of("whole"));
}

// Writes fail at random, as on a disk that fills up and is emptied: every run ends with a message
// or well, and in the end nothing is lost.
TEST_F(Resume, LosesNothingWhereWritesFailAtRandom) {
  if (shell("command -v fiu-run").code != 0) GTEST_SKIP() << "fiu-run is missing: see packages.txt";
  ASSERT_EQ(modcal("run sweep.yaml --out whole").code, 0);
  int failures = 0;
  for (int attempt = 0; attempt < 12; ++attempt) {
    const Outcome outcome = shell(
        "fiu-run -x -c 'enable_random name=posix/io/rw/write,probability=0.1,failinfo=28' "
        "-c 'enable_random name=posix/io/rw/pwrite,probability=0.1,failinfo=28' '" MODCAL_PROGRAM
        "' run sweep.yaml --threads 2 --out a");
    ASSERT_TRUE(outcome.code == 0 || outcome.code == 3) << outcome.code << outcome.err;
    if (outcome.code == 0) continue;
    ++failures;
    EXPECT_THAT(outcome.err, HasSubstr("No space left on device"));
  }
  EXPECT_GT(failures, 0);
  ASSERT_EQ(modcal("run sweep.yaml --out a").code, 0);
  EXPECT_EQ(tables_of("a"), tables_of("whole"));
  EXPECT_EQ(json::parse(modcal("status a --json").out)["damaged_lines"], 0);
}

TEST_F(Resume, RefusesAFolderThatCannotBeWritten) {
  ASSERT_EQ(modcal("run sweep.yaml --out a --shard 1/2").code, 0);
  const std::string half = content_of(folder() / "a/journal/shard-1-of-2.journal");
  // Root may write anywhere but into what is no folder, or below /proc.
  for (const char* out : {"/proc/modcal", "a/provenance.json"}) {
    const Outcome outcome = modcal(std::string("run sweep.yaml --out ") + out);
    EXPECT_EQ(outcome.code, 3) << out;
    EXPECT_THAT(outcome.err, HasSubstr("choose another one with --out")) << out;
  }
  EXPECT_EQ(content_of(folder() / "a/journal/shard-1-of-2.journal"), half);
}

TEST_F(Resume, RefusesShardsOfWhatIsNoList) {
  std::string text(kSweep);
  text.replace(text.find("sweep"), 5, "invert");
  write("invert.yaml", text.substr(0, text.find("sweep:\n")));
  const Outcome outcome = modcal("run invert.yaml --out a --shard 1/2");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("kind invert is no list of tasks"));
  EXPECT_EQ(modcal("run sweep.yaml --out a --shard 3/2").code, 2);
}

}  // namespace
}  // namespace modcal::resume_test
