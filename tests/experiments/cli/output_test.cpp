// What a command has computed reaches the user, or its exit code says that it has not.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::output_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kOutputLost = 7;

class Output : public testing::SmallRuns {
 protected:
  // Runs a list of tasks and `harm` as soon as `journal` holds one of them: seconds of work are
  // left, on a machine that does other things, too.
  Outcome run_while(const std::string& file, const std::string& harm,
                    const std::string& journal = "a/journal/*.journal") const {
    return shell("'" MODCAL_PROGRAM "' run " + file + " --out a --threads 1 " + kLongTasks +
                 " & while [ $(cat " + journal + " 2>/dev/null | wc -l) -lt 2 ]; do sleep 0.01; " +
                 "done; " + harm + "; wait $!");
  }
  const std::string kLongTasks = "--set scene.duration='60 s'";
};

TEST_F(Output, IsAnErrorWhereStandardOutputTakesNothing) {
  ASSERT_EQ(modcal("run list.yaml --out a").code, 0);
  for (const char* command :
       {"run small.yaml --out b", "run list.yaml --out a", "validate small.yaml",
        "validate small.yaml --json", "list", "describe simulator modal_exact", "schema",
        "plan small.yaml", "merge a", "status a", "status a --json", "report a", "--help",
        "--version", "run --help"}) {
    const Outcome full = modcal(std::string(command) + " >/dev/full");
    EXPECT_EQ(full.code, kOutputLost) << command;
    EXPECT_THAT(full.err, HasSubstr("standard output has not taken the answer: No space left"))
        << command;
    EXPECT_THAT(full.err, Not(HasSubstr("internal"))) << command;
  }
  // What was computed is there nevertheless.
  EXPECT_TRUE(std::filesystem::exists(folder() / "b/report.html"));
  EXPECT_EQ(modcal("validate small.yaml >&-").code, kOutputLost);
  EXPECT_EQ(modcal("run small.yaml --out c >&-").code, kOutputLost);
  // Nothing was to be said there.
  EXPECT_EQ(modcal("validate missing.yaml >&-").code, 3);
}

TEST_F(Output, AReaderThatGoesAwayEndsNoRunAndIsNoError) {
  // Nobody reads any longer when the command begins to say something.
  const auto to_nobody = [this](const std::string& arguments) {
    const Outcome gone =
        shell("{ sleep 0.2; '" MODCAL_PROGRAM "' " + arguments + " 2>err; echo $? >code; } | true");
    return Outcome{gone.code, content_of(folder() / "code"), content_of(folder() / "err")};
  };
  const Outcome run = to_nobody("run list.yaml --out a");
  EXPECT_EQ(run.out, "0\n");
  EXPECT_TRUE(std::filesystem::exists(folder() / "a/report.html"));
  for (const char* command : {"schema", "describe simulator modal_exact", "list --json"}) {
    const Outcome gone = to_nobody(command);
    EXPECT_EQ(gone.out, "0\n") << command;
    EXPECT_EQ(gone.err, "") << command;
  }
  EXPECT_EQ(to_nobody("validate missing.yaml").out, "3\n");
}

TEST_F(Output, WorksOnWhereStandardErrorTakesNothing) {
  for (const char* error : {"2>/dev/full", "2>&-"}) {
    const Outcome run = modcal(std::string("run list.yaml --out a --set seed=1 ") + error);
    EXPECT_EQ(run.code, 0) << error;
    EXPECT_THAT(run.out, Not(IsEmpty()));
    // Nothing that was to be said there stands in a file.
    const std::string journal = content_of(folder() / "a/journal/shard-1-of-1.journal");
    EXPECT_EQ(std::count(journal.begin(), journal.end(), '\n'), 1 + 8);
    std::filesystem::remove_all(folder() / "a");
    EXPECT_EQ(modcal(std::string("validate missing.yaml ") + error).code, 3);
    EXPECT_EQ(modcal(std::string("nonsense ") + error).code, 2);
  }
}

TEST_F(Output, NoticesThatResultsAreDeletedOrMovedWhileItWorks) {
  for (const char* harm : {"rm -r a", "mv a b", "rm -r a/journal", "mv a/journal j",
                           "rm a/journal/*.journal", "mv a/journal/shard-1-of-1.journal x"}) {
    const Outcome outcome = run_while("list.yaml", harm);
    EXPECT_EQ(outcome.code, kOutputLost) << harm << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("was deleted, moved or replaced while the command worked"))
        << harm;
    EXPECT_THAT(outcome.err, HasSubstr("shard-1-of-1.journal")) << harm;
    shell("rm -rf a b j x");
  }
  for (const char* file : {"resolved.yaml", "provenance.json"}) {
    const Outcome outcome = run_while("list.yaml", std::string("rm a/") + file);
    EXPECT_EQ(outcome.code, kOutputLost) << file << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(std::string("a/") + file + ": the file was deleted"));
    // All else is there.
    EXPECT_TRUE(std::filesystem::exists(folder() / "a/report.html"));
    shell("rm -rf a");
  }
}

TEST_F(Output, NoticesThatAnotherShardsJournalIsGone) {
  ASSERT_EQ(modcal("run list.yaml --out a --shard 1/4 " + kLongTasks).code, 0);
  const Outcome outcome =
      run_while("list.yaml", "rm a/journal/shard-1-of-4.journal", "a/journal/shard-1-of-1.journal");
  EXPECT_EQ(outcome.code, kOutputLost);
  EXPECT_THAT(outcome.err, HasSubstr("a/journal/shard-1-of-4.journal: the journal was deleted"));
}

TEST_F(Output, WritesWhatItFoundWhereTheFolderOfASingleRunIsGone) {
  const Outcome outcome =
      shell("'" MODCAL_PROGRAM
            "' run small.yaml --out a --set scene.duration='300 s' & "
            "until [ -e a/provenance.json -a -e a/resolved.yaml ]; do sleep 0.01; done; "
            "mv a b; wait $!");
  EXPECT_EQ(outcome.code, kOutputLost);
  EXPECT_THAT(outcome.err, HasSubstr("the folder of the results was deleted, moved or replaced"));
  EXPECT_TRUE(std::filesystem::exists(folder() / "a/report.html"));
}

}  // namespace
}  // namespace modcal::output_test
