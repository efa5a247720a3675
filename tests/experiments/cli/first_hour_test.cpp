// What a newcomer does: from a recorded file to the string and the force with their error bars.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::first_hour_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// The record that comes with the program, of a string by finite differences whose law and contact
// its first lines state.
class FirstHour : public testing::ProgramTest {
 protected:
  FirstHour() {
    std::filesystem::copy_file(std::string(MODCAL_EXAMPLES) + "/bowed_violin_d.csv",
                               folder() / "record.csv");
  }
  // Of the true force, as the run says; NaN: it does not.
  static double percent_within_the_band(const std::string& said) {
    const std::regex share("([0-9.]+) % within the 95 % band");
    std::smatch match;
    return std::regex_search(said, match, share) ? std::stod(match[1]) : std::nan("");
  }
  std::string first_line(const std::string& file) const {
    std::istringstream stream(content_of(folder() / file));
    std::string line;
    std::getline(stream, line);
    return line;
  }
};

TEST_F(FirstHour, GoesFromARecordToTheForceWithItsBand) {
  const Outcome paper = modcal("reproduce table1");
  ASSERT_EQ(paper.code, 0) << paper.err;
  EXPECT_THAT(content_of(folder() / "out/table1/report.html"), HasSubstr("Table 1"));
  ASSERT_EQ(modcal("new calibrate record.csv --length '0.33 m' --out mine.yaml").code, 0);
  const Outcome valid = modcal("validate mine.yaml");
  ASSERT_EQ(valid.code, 0) << valid.err;
  const Outcome run = modcal("run mine.yaml --set write_sound=true");
  ASSERT_EQ(run.code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("within the 95 % band"));
  const auto found =
      nlohmann::json::parse(content_of(folder() / "out/mine/calibration.json")).at("parameters");
  const std::map<std::string, double> truth = {{"f0", 294.0}, {"B", 1.1e-4}, {"x_c", 0.041}};
  std::size_t judged = 0;
  for (const auto& parameter : found) {
    const auto known = truth.find(parameter.at("name"));
    if (known == truth.end()) continue;
    ++judged;
    const double deviation = parameter.at("sd");
    EXPECT_LT(std::abs(parameter.at("final").get<double>() - known->second), 2.5 * deviation)
        << known->first;
    EXPECT_LT(deviation, 1e-3 * known->second) << known->first;
  }
  EXPECT_EQ(judged, 3u);
  EXPECT_EQ(first_line("out/mine/identified.csv"),
            "t [s],y_joint [m],y_joint_deviation [m],v_joint [m/s],v_joint_deviation [m/s],"
            "f_c_joint [N],f_c_joint_deviation [N]");
  // What the band is of stands in the file and on the page; the sound is the same, bit for bit.
  const std::string csv = content_of(folder() / "out/mine/identified.csv");
  EXPECT_THAT(csv,
              HasSubstr("# side joint: signals and deviations are those of what lies below 1"));
  ASSERT_EQ(modcal("convert out/mine/identified.wav back.csv").code, 0);
  EXPECT_EQ(
      shell("grep -v '^#' back.csv >back; grep -v '^#' out/mine/identified.csv | cmp - back").code,
      0);
  const std::string page = content_of(folder() / "out/mine/report.html");
  EXPECT_THAT(page, HasSubstr("The band is that of what lies below 1"));
  for (const char* figure :
       {"identified_force", "identified_motion", "frequencies_against_law", "reaction_spectra",
        "reaction_ratio", "Correlations of the parameters"}) {
    EXPECT_THAT(page, HasSubstr(figure));
  }
}

TEST_F(FirstHour, NeedsNoObjectiveNorEstimator) {
  ASSERT_EQ(modcal("new invert record.csv --length '0.33 m' --out mine.yaml").code, 0);
  EXPECT_THAT(content_of(folder() / "mine.yaml"), Not(HasSubstr("estimator")));
  const Outcome run = modcal("run mine.yaml");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("side joint"));
  // The damping is a guess.
  EXPECT_THAT(run.out, HasSubstr("the reactions contradict each other"));
  EXPECT_THAT(run.out, HasSubstr("\nto try: calibrate the string first (kind: calibrate)\n"));
  const Outcome edge = modcal(
      "run mine.yaml --out edge --set 'inversion={estimator: one_sided, "
      "parameter_choice: {type: l_curve, lowest: 100, highest: 200}}'");
  EXPECT_THAT(edge.out, HasSubstr("\nto try: choose the parameter by another rule"));
  // One reaction is enough for a force with a band.
  const Outcome one = modcal(
      "new invert record.csv --length '0.33 m' | grep -v right: > one.yaml && '" MODCAL_PROGRAM
      "' run one.yaml");
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("reaction 2 is missing"));
  // The damping in the file is a guess, of which the band does not know.
  EXPECT_GT(percent_within_the_band(one.out), 85.0) << one.out;
  // Nor has it to start at rest.
  const Outcome late = modcal("run one.yaml --set 'record.start=0.2 s' --out late");
  ASSERT_EQ(late.code, 0) << late.err;
  EXPECT_GT(percent_within_the_band(late.out), 85.0) << late.out;
  EXPECT_THAT(first_line("out/one/identified.csv"), HasSubstr("f_c_joint_deviation [N]"));
}

TEST_F(FirstHour, IsToldOfASearchThatWasCut) {
  ASSERT_EQ(modcal("new calibrate record.csv --length '0.33 m' --out mine.yaml").code, 0);
  const Outcome cut = modcal("run mine.yaml --set calibration.budget.evaluations=5");
  EXPECT_NE(cut.code, 0);
  EXPECT_THAT(cut.out, HasSubstr("before it found anything: raise calibration.budget"));
  EXPECT_THAT(content_of(folder() / "out/mine/report.html"), Not(HasSubstr("All done")));
  // For programs its verdict is the message, and what is no list says where its answer stands.
  const Outcome data =
      modcal("run mine.yaml --json --out data --set calibration.budget.evaluations=5");
  EXPECT_THAT(data.out, Not(HasSubstr("nothing could be measured")));
  EXPECT_THAT(data.out.substr(data.out.find("\"error\"")), HasSubstr("calibration.budget"));
  EXPECT_THAT(modcal("status data").err, HasSubstr("its answer stands in data/answer.json"));
  // Between two of its stages, too: there is a value, of another record than the whole.
  EXPECT_NE(modcal("run mine.yaml --out later --set calibration.budget.evaluations=60").code, 0);
  const Outcome short_of = modcal(
      "run mine.yaml --out short --set calibration='{objective: spectral_peak, optimizer: nlopt, "
      "parameters: {frequencies: none, law: true}, budget: {evaluations: 5}}'");
  EXPECT_THAT(short_of.out, HasSubstr("a better point may lie beyond; raise calibration.budget"));
  EXPECT_THAT(content_of(folder() / "short/report.html"), HasSubstr("Cut by its budget: "));
}

// With one sensor turned another pitch, .7 of this one, explains a sharp pluck a little better.
TEST_F(FirstHour, ReadsThePitchOfAPluck) {
  write("pluck.yaml",
        "kind: simulate\n"
        "scene:\n"
        "  string: {length: 0.33 m, linear_density: 3.1 g/m, fundamental: 196 Hz, inharmonicity: "
        "1e-4, modes: 40, damping: {type: constant, ratio: 1e-3}}\n"
        "  bow: {position: 40 mm, velocity: 0 m/s, normal_force: 0 N}\n"
        "  initial: {type: pluck, position: 70 mm, displacement: 1 mm}\n"
        "  duration: 1 s\n"
        "measurement: {sample_rate: 51.2 kHz, noise_level: 1 %}\n"
        "files: [csv]\n");
  ASSERT_EQ(modcal("run pluck.yaml").code, 0);
  const Outcome written = modcal("new calibrate out/pluck/signals.csv --length '0.33 m'");
  EXPECT_THAT(written.out, HasSubstr("fundamental: 196."));
  EXPECT_THAT(written.out, HasSubstr("right: {channel: \"R2\"}"));
  EXPECT_THAT(written.out, HasSubstr("State bow.position"));
}

TEST_F(FirstHour, NeedNotKnowHowASensorWasMounted) {
  // The reaction at x = L with the other sign.
  ASSERT_EQ(
      shell("awk -F, '/^-?[0-9]/ {print $1 \",\" (-$2); next} /^#/ {print; next} {print $1 \",\" "
            "$2}' record.csv > turned.csv")
          .code,
      0);
  const Outcome written =
      modcal("new invert turned.csv --length '0.33 m' --out turned.yaml && cat turned.yaml");
  EXPECT_THAT(written.out, HasSubstr("turned: true"));
  EXPECT_EQ(modcal("validate turned.yaml").code, 0);
  const Outcome without = modcal("validate turned.yaml --set record.right.turned=false");
  EXPECT_EQ(without.code, 3);
  EXPECT_THAT(without.err, HasSubstr("state turned: true"));
}

TEST_F(FirstHour, IsToldOfOneSignalAtBothEndsAndOfAWrongGain) {
  ASSERT_EQ(shell("sed 's/,f_c .N.//' record.csv > two.csv; awk -F, '/^-?[0-9]/ {print $1 \",\" "
                  "$1; next} {print}' two.csv > copied.csv")
                .code,
            0);
  for (const char* words : {"new calibrate copied.csv", "inspect copied.csv"}) {
    const Outcome refused = modcal(words);
    EXPECT_EQ(refused.code, 3) << words;
    EXPECT_THAT(refused.out + refused.err, HasSubstr("R1 and R2 are one signal")) << words;
  }
  ASSERT_EQ(
      shell("awk -F, '/^-?[0-9]/ {print $1 \",\" 1.3*$2; next} {print}' two.csv > gain.csv").code,
      0);
  ASSERT_EQ(modcal("new invert gain.csv --out gain.yaml").code, 0);
  EXPECT_THAT(modcal("run gain.yaml").out, HasSubstr("\nto try: check the gains of both sensors"));
  // Before what is folded.
  const std::string page = content_of(folder() / "out/gain/report.html");
  const std::string first_screen =
      page.substr(0, page.find("<details class=\"fold\"><summary><h2>"));
  EXPECT_THAT(first_screen, HasSubstr("doubtful (see the warning)"));
  EXPECT_THAT(first_screen, HasSubstr("the reactions contradict each other"));
  EXPECT_THAT(first_screen, HasSubstr("To try: "));
  const Outcome calibrated =
      modcal("run gain.yaml --set kind=calibrate --set string.modes=20 --out calibrated");
  EXPECT_THAT(calibrated.out, HasSubstr("check the gains of both sensors"));
  EXPECT_THAT(calibrated.out, Not(HasSubstr("(kind: calibrate)")));
}

TEST_F(FirstHour, MayHaveNamesThatYamlWouldMisread) {
  ASSERT_EQ(shell("sed 's/^R1 \\[N\\],R2/\"a: \"\"1\"\" #2\\\\ [N]\",- b/' record.csv > 'it: "
                  "\"mine\" #1.csv'")
                .code,
            0);
  const Outcome written =
      modcal("new invert 'it: \"mine\" #1.csv' --length '0.33 m' --out mine.yaml");
  ASSERT_EQ(written.code, 0) << written.err;
  EXPECT_THAT(content_of(folder() / "mine.yaml"), HasSubstr(R"("a: \"1\" #2\\")"));
  const Outcome valid = modcal("validate mine.yaml");
  EXPECT_EQ(valid.code, 0) << valid.err;
  EXPECT_EQ(modcal("new invert record.csv --out nowhere/mine.yaml").code, 3);
}

TEST_F(FirstHour, IsToldAtValidateWhatTheRecordLacks) {
  ASSERT_EQ(modcal("new calibrate record.csv --length '0.33 m' --out mine.yaml").code, 0);
  const auto refused = [this](const std::string& set, const std::string& place,
                              const std::string& reason) {
    const Outcome outcome = modcal("validate mine.yaml --set " + set);
    EXPECT_EQ(outcome.code, 3) << set;
    EXPECT_THAT(outcome.err, HasSubstr(place)) << set;
    EXPECT_THAT(outcome.err, HasSubstr(reason)) << set;
  };
  refused("record.file=nowhere.csv", "--set", "cannot be opened");
  refused("record.left.channel=R7", "--set", "there is no channel \"R7\"");
  refused("record.left.delay='5 s'", "--set", "a delay of 5 s does not fit");
  refused("record.start='2 s'", "--set", "is not in the record");
  refused("bow.position='290 mm'", "mine.yaml:5:", "exchanged");
  refused("'score={windows: [0.6 s]}'", "--set", "is not inside the record");
  refused("'figures=[{id: late, windows: [{start: 3 s}]}]'", "--set", "holds nothing of a record");
}

TEST_F(FirstHour, MayNameOneEndOtherwise) {
  for (const char* names : {"bridge [N],R2", "R1 [N],nut",
                            "Kr\xC3\xA4"
                            "ft1 [N],R2"}) {
    ASSERT_EQ(shell(fmt::format("sed 's/^R1 .N.,R2/{}/; s/,f_c .N.//' record.csv | awk -F, "
                                "'/^-?[0-9]/ {{print $1 \",\" $2; next}} {{print}}' > other.csv",
                                names))
                  .code,
              0);
    const Outcome written = modcal("new invert other.csv --length '0.33 m'");
    EXPECT_EQ(written.code, 0) << names << written.err;
    EXPECT_THAT(written.out, HasSubstr("position: 41")) << names;
    EXPECT_EQ(modcal("inspect other.csv").code, 0) << names;
  }
  ASSERT_EQ(shell("sed 's/R2/somewhat/; s/somewhat .N./somewhat/' record.csv > other.csv").code, 0);
  const Outcome refused = modcal("new invert other.csv");
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("only one of its channels (R1, somewhat, f_c) is told to be a "
                                     "reaction, R1: "));
}

TEST_F(FirstHour, IsToldThatARunIsNotFinished) {
  ASSERT_EQ(modcal("new calibrate record.csv --length '0.33 m' --out mine.yaml").code, 0);
  const Outcome killed = shell("'" MODCAL_PROGRAM
                               "' run mine.yaml --out 'a b' & "
                               "while [ ! -f 'a b/resolved.yaml' ]; do sleep 0.02; done; "
                               "'" MODCAL_PROGRAM "' status 'a b' 2> running; kill -KILL $!; wait");
  ASSERT_TRUE(std::filesystem::exists(path("running"))) << killed.err;
  EXPECT_THAT(content_of(path("running")),
              HasSubstr("and works there now: its answer will stand in a b/answer.json"));
  for (const char* command : {"status", "report"}) {
    const Outcome said = modcal(std::string(command) + " 'a b'");
    EXPECT_EQ(said.code, 3);
    EXPECT_THAT(said.err, HasSubstr("and is not finished: it was stopped, or failed, and has left "
                                    "no answer; run it again with:\n  modcal run mine.yaml --out "
                                    "'a b'\n"));
  }
}

TEST_F(FirstHour, HasAnExampleOfEveryKind) {
  const Outcome kinds = modcal("list experiment");
  ASSERT_EQ(kinds.code, 0);
  std::istringstream lines(kinds.out);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string kind = line.substr(0, line.find(' '));
    if (kind.empty()) continue;
    ++count;
    const Outcome written = modcal(fmt::format("new {0} --out {0}.yaml", kind));
    EXPECT_EQ(written.code, 0) << kind << written.err;
    // What its sections are for stands beside them.
    EXPECT_THAT(content_of(folder() / (kind + ".yaml")), HasSubstr("  # ")) << kind;
    EXPECT_EQ(modcal("validate " + kind + ".yaml").code, 0) << kind;
  }
  EXPECT_GE(count, 9u);
  EXPECT_THAT(modcal("new calibrte").err, HasSubstr("did you mean \"calibrate\"?"));
  EXPECT_EQ(modcal("new invert --out invert.yaml").code, 3);  // is there
}

}  // namespace
}  // namespace modcal::first_hour_test
