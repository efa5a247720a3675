// What every command has in common: help, --json, --quiet, and the texts made of the commands.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::answers_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

class Answers : public testing::SmallRuns {
 protected:
  Answers() {
    std::filesystem::copy_file(std::string(MODCAL_EXAMPLES) + "/bowed_violin_d.csv",
                               path("record.csv"));
  }
  std::vector<std::string> commands() const {
    std::istringstream lines(modcal("help").out);
    std::vector<std::string> names;
    bool listed = false;
    for (std::string line; std::getline(lines, line) && (!listed || !line.empty());) {
      if (listed) names.push_back(line.substr(2, line.find(' ', 2) - 2));
      listed = listed || line == "Subcommands:";
    }
    return names;
  }
};

TEST_F(Answers, AreOneJsonObjectOfEveryCommand) {
  ASSERT_EQ(modcal("run list.yaml --out listed").code, 0);
  write("long.yaml", testing::kSmallSimulation + testing::many_seeds(50));
  const std::map<std::string, std::pair<std::string, std::string>> cases = {
      {"run", {"run small.yaml", "report"}},
      {"validate", {"validate small.yaml", "mistakes"}},
      {"limit",
       {"limit '" + std::string(MODCAL_EXAMPLES) +
            "/../configs/beyond/calibrate_to_the_bound.yaml' --set scene.duration='0.2 s'",
        "parameters"}},
      {"plan", {"plan small.yaml", "price"}},
      {"list", {"list optimizer", ""}},
      {"describe", {"describe optimizer nlopt", "options"}},
      {"schema", {"schema", "$schema"}},
      {"inspect", {"inspect record.csv", "channels"}},
      {"convert", {"convert record.csv other.uff", "channels"}},
      {"new", {"new calibrate record.csv --length '0.33 m' --out mine.yaml", "file"}},
      {"reproduce", {"reproduce fig02", "report"}},
      {"status", {"status listed", "pending"}},
      {"merge", {"merge listed", "digest"}},
      {"report", {"report listed", "report"}},
      {"replay", {"replay listed 1", "axes"}},
      {"compare", {"compare listed listed --number levels.y.std", "ratio"}},
      {"submit", {"submit long.yaml --slurm --dry-run", "scripts"}},
      {"help", {"help run", "text"}},
      {"completion", {"completion bash", "text"}},
      {"man", {"man", "text"}}};
  for (const std::string& command : commands()) {
    ASSERT_TRUE(cases.contains(command)) << command;
    const auto& [words, key] = cases.at(command);
    const Outcome outcome = modcal(words + " --json");
    EXPECT_EQ(outcome.code, 0) << words << outcome.out << outcome.err;
    const json answer = json::parse(outcome.out, nullptr, false);
    ASSERT_FALSE(answer.is_discarded()) << words << outcome.out;
    EXPECT_TRUE(key.empty() ? answer.is_array() : answer.contains(key)) << words << answer;
  }
}

TEST_F(Answers, TellErrorsAndWarningsAsData) {
  const json wrong = json::parse(modcal("run small.yaml --set seed=x --json").out);
  EXPECT_EQ(wrong["error"]["kind"], "invalid_input");
  EXPECT_EQ(wrong["error"]["exit_code"], 3);
  EXPECT_EQ(wrong["error"]["place"]["option"], "--set 1");
  EXPECT_EQ(wrong["mistakes"][0]["text"], "seed must be a whole number, not \"x\"");
  write("tab.yaml", "kind: simulate\n\tscene: 1\n");
  const json place = json::parse(modcal("plan tab.yaml --json").out)["error"]["place"];
  EXPECT_EQ(place, json({{"file", "tab.yaml"}, {"line", 2}, {"column", 1}}));
  const json usage = json::parse(modcal("run --json").out);
  EXPECT_EQ(usage["error"]["kind"], "usage");
  EXPECT_EQ(usage["error"]["place"], nullptr);
  const json absent = json::parse(modcal("inspect 'no: record.csv' --json").out);
  EXPECT_EQ(absent["error"]["place"], json({{"file", "no: record.csv"}}));
  write("a b.csv", "R1 [N],R2 [N]\n1,2\n1,\"2\n");
  const json damaged = json::parse(modcal("inspect 'a b.csv' --sample-rate 1000 --json").out);
  EXPECT_EQ(damaged["error"]["place"], json({{"file", "a b.csv"}, {"line", 3}}));
  const json length = json::parse(modcal("new calibrate record.csv --length x --json").out);
  EXPECT_EQ(length["error"]["place"], json({{"option", "--length"}}));
  const json warned = json::parse(
      modcal("validate small.yaml --set scene.string.fundamental='0.196 Hz' --json").out);
  EXPECT_EQ(warned["valid"], true);
  EXPECT_THAT(warned["warnings"][0], HasSubstr("which no string carries"));
}

TEST_F(Answers, AreQuietWhereThatIsAskedFor) {
  EXPECT_THAT(modcal("run small.yaml --out a").err, HasSubstr("report: a/report.html"));
  const Outcome quiet = modcal("run small.yaml --out a -q");
  EXPECT_EQ(quiet.err, "");
  EXPECT_THAT(quiet.out, HasSubstr("steps"));
  EXPECT_THAT(modcal("run small.yaml --quiet --set seed=x").err, HasSubstr("error: "));
}

TEST_F(Answers, ATerminalShowsThatLongWorkGoesOn) {
  const auto seen = [this](const std::string& words) {
    return shell("TERM=xterm script -qec \"'" MODCAL_PROGRAM "' " + words + "\" /dev/null").out;
  };
  const std::string slow = "--set scene.duration='60 s' --set simulator.time_step='1 us' ";
  EXPECT_THAT(seen("run small.yaml --out a " + slow),
              ContainsRegex("small: [0-9]+ %, [0-9]+ s left"));
  EXPECT_THAT(seen("new calibrate record.csv --length 0.33 --out mine.yaml; '" MODCAL_PROGRAM
                   "' run mine.yaml"),
              ContainsRegex("record.csv: [0-9]+ s"));
  // A command that says nothing of its share: the line is gone before the answer.
  EXPECT_THAT(seen("plan '" + std::string(MODCAL_EXAMPLES) + "/../configs/schelleng.yaml'"),
              ContainsRegex("plan: [0-9]+ s.*tasks: 4096"));
  EXPECT_THAT(seen("run small.yaml --quiet --out b " + slow), Not(HasSubstr("small: ")));
  // Nor where nobody sees it.
  EXPECT_THAT(modcal("run small.yaml --out c " + slow).err, Not(HasSubstr("small: ")));
}

TEST_F(Answers, HelpHasExamplesAndExitCodes) {
  const Outcome bare = modcal("");
  EXPECT_EQ(bare.code, 2);
  for (const std::string& text : {bare.err, modcal("--help").out, modcal("help").out}) {
    EXPECT_THAT(text, AllOf(HasSubstr("Examples:\n  modcal inspect record.csv"),
                            HasSubstr("Exit codes:\n  0   ok"), HasSubstr("130 interrupted")));
  }
  for (const std::string& command : commands()) {
    const Outcome help = modcal("help " + command);
    EXPECT_THAT(help.out, ContainsRegex("Examples:\n  modcal " + command)) << command;
    EXPECT_EQ(help.out, modcal(command + " --help").out);
  }
  EXPECT_EQ(modcal("-V").out, modcal("--version").out);
}

TEST_F(Answers, HelpOfExamplesIsTrue) {
  // Every example's words are known to its command.
  for (const std::string& command : commands()) {
    const std::string help = modcal("help " + command).out;
    for (std::size_t at = help.find("  modcal "); at != std::string::npos;
         at = help.find("  modcal ", at + 1)) {
      const std::string line = help.substr(at + 9, help.find_first_of("\n>|", at) - at - 9);
      const Outcome outcome = modcal(line);
      EXPECT_NE(outcome.code, 2) << line << outcome.err;
      EXPECT_NE(outcome.code, 1) << line << outcome.err;
    }
  }
}

TEST_F(Answers, CompletionIsTakenByItsShell) {
  for (const std::string shell_name : {"bash", "zsh", "fish"}) {
    const std::string script = fmt::format("script.{}", shell_name);
    ASSERT_EQ(
        shell(fmt::format("'" MODCAL_PROGRAM "' completion {} > {}", shell_name, script)).code, 0);
    const Outcome parsed = shell(fmt::format("{} -n {}", shell_name, script));
    EXPECT_EQ(parsed.code, 0) << shell_name << parsed.err;
    const std::string text = content_of(path(script));
    for (const std::string& command : commands()) EXPECT_THAT(text, HasSubstr(command));
  }
  const auto completed = [this](const std::string& words, int word) {
    return shell("PATH=\"$(dirname '" MODCAL_PROGRAM
                 "'):$PATH\" bash -c '. ./script.bash; COMP_WORDS=(" +
                 words + "); COMP_CWORD=" + std::to_string(word) +
                 "; _modcal; echo ${COMPREPLY[@]}'")
        .out;
  };
  EXPECT_EQ(completed("modcal va", 1), "validate\n");
  EXPECT_EQ(completed("modcal run --sh", 2), "--shard\n");
  EXPECT_EQ(completed("modcal describe opt", 2), "optimizer\n");
  EXPECT_EQ(completed("modcal describe optimizer nl", 3), "nlopt\n");
  EXPECT_EQ(completed("modcal new cal", 2), "calibrate calibration_limit\n");
  const std::string path = "PATH=\"$(dirname '" MODCAL_PROGRAM "'):$PATH\" ";
  const auto in_fish = [&](const std::string& words) {
    return shell(path + "fish -c \"source script.fish; complete -C '" + words + "'\" | cut -f1")
        .out;
  };
  EXPECT_EQ(in_fish("modcal va"), "validate\n");
  EXPECT_EQ(in_fish("modcal describe opt"), "optimizer\n");
  EXPECT_EQ(in_fish("modcal describe optimizer nl"), "nlopt\n");
  EXPECT_EQ(in_fish("modcal new cal"), "calibrate\ncalibration_limit\n");
}

TEST_F(Answers, ManualPageIsWellFormed) {
  ASSERT_EQ(shell("'" MODCAL_PROGRAM "' man > modcal.1").code, 0);
  // The page has no date: the same program gives the same page.
  const Outcome lint = shell("mandoc -T lint -W warning modcal.1 | grep -v 'missing date'");
  EXPECT_EQ(lint.out, "");
  const Outcome page = shell("mandoc -T utf8 modcal.1 | col -b");
  for (const std::string& command : commands()) {
    EXPECT_THAT(page.out, HasSubstr("modcal " + command));
  }
  EXPECT_THAT(page.out, AllOf(HasSubstr("--most-jobs"), HasSubstr("EXIT STATUS"),
                              HasSubstr("modcal run mine.yaml --set seed=2 --out second")));
}

}  // namespace
}  // namespace modcal::answers_test
