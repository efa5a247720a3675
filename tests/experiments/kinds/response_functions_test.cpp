// Measured response functions: modes that are fitted to them, and a table of them in the place of
// modes, from the file to the force.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"
#include "libsim/base/error.hpp"
#include "libsim/records/formats.hpp"
#include "libsim/signal/fft.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::response_functions_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kStructures = std::string(MODCAL_CONFIGS) + "/structures/";

StudyResult run(YamlDocument document) {
  const LoadedExperiment loaded = load_experiment(std::move(document));
  if (!loaded.experiment) throw InvalidInput(format_mistakes(loaded.document, loaded.mistakes));
  SharedWork work;
  return loaded.experiment->run(
      {.work = work, .folder = loaded.document.folder(), .command = "test"});
}

class ResponseFunctionsOf : public FolderTest {
 protected:
  // A universal file of an acceleration in g per lbf with two modes, from 5 to 200 Hz. decay [1/s]:
  // of the window by which force and response were weighted.
  void write_function(double decay = 0.0) const {
    constexpr double kTurn = 6.283185307179586, kGravity = 9.80665, kPound = 4.4482216152605;
    std::string text =
        "    -1\n    58\nacc\nNONE\nNONE\nNONE\nNONE\n"
        "    4         0    0         0 NONE               1   3 NONE               2   3\n";
    text += fmt::format("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", 6, 391, 1, 5.0, 0.5, 0.0);
    for (const auto& [code, label, unit] :
         {std::tuple(18, "Frequency", "Hz"), std::tuple(12, "Acceleration", "g"),
          std::tuple(13, "Force", "lbf"), std::tuple(0, "NONE", "NONE")}) {
      text += fmt::format("{:10}{:5}{:5}{:5} {:20} {:20}\n", code, 0, 0, 0, label, unit);
    }
    for (std::size_t m = 0; m < 391; ++m) {
      const Complex s(decay, kTurn * (5.0 + 0.5 * static_cast<double>(m)));
      const Complex h = s * s *
                        (2.0 / ModalPole{kTurn * 60.0, 0.01}.denominator(s) -
                         1.5 / ModalPole{kTurn * 130.0, 0.02}.denominator(s)) /
                        kGravity * kPound;
      text += fmt::format("{:20.12E}{:20.12E}\n", h.real(), h.imag());
    }
    write("acc.uff", text + "    -1\n");
  }
  StudyResult run_file(const std::string& keys) const {
    write("fit.yaml", "kind: fit_modes\n" + keys);
    return run(read_yaml_file(path("fit.yaml")));
  }
  // Fits the file and compares with what it was made of.
  void expect_modes(const std::string& keys) const {
    const StudyResult result = run_file("functions: {file: acc.uff, responses: [{channel: acc}]" +
                                        keys + "}\nlow: 10\nhigh: 190\n");
    ASSERT_EQ(result.status, report::Status::kOk) << result.summary;
    for (const auto& [file, text] : result.files) {
      if (file == "table.yaml") write("table.yaml", text);
    }
    const StructureTable table = read_table(path("table.yaml"));
    // 13 digits were written; a mode more than there are would take what rounding leaves.
    ASSERT_GE(table.model.poles.size(), 2u);
    const auto mode_near = [&](double frequency) {
      std::size_t best = 0;
      for (std::size_t n = 0; n < table.model.poles.size(); ++n) {
        if (std::abs(table.frequency(n) - frequency) <
            std::abs(table.frequency(best) - frequency)) {
          best = n;
        }
      }
      return best;
    };
    for (const auto& [frequency, ratio, constant] :
         {std::tuple(60.0, 0.01, 2.0), std::tuple(130.0, 0.02, -1.5)}) {
      const std::size_t n = mode_near(frequency);
      EXPECT_NEAR(table.frequency(n), frequency, 1e-6);
      EXPECT_NEAR(table.model.poles[n].zeta, ratio, 1e-7);
      EXPECT_NEAR(table.model.constant(0, n), constant, 1e-5);
    }
  }
};

TEST_F(ResponseFunctionsOf, AUniversalFileGiveModesInSi) {
  write_function();
  expect_modes("");
}

TEST_F(ResponseFunctionsOf, AnExponentialWindowIsNoDamping) {
  write_function(3.0);
  expect_modes(", exponential_window: 0.3333333333333333 s");
}

TEST_F(ResponseFunctionsOf, AreRefusedWhereTheyAreNone) {
  write_function();
  const auto said = [&](const std::string& keys) {
    try {
      run_file(keys + "low: 10\nhigh: 190\n");
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(said(""), HasSubstr("state record:"));
  EXPECT_THAT(said("functions: {file: acc.uff, responses: [{channel: b}]}\n"), HasSubstr("\"b\""));
  EXPECT_THAT(said("functions: {file: acc.uff, responses: [{channel: acc, kind: velocity}]}\n"),
              HasSubstr("in \"g\" per \"lbf\", which is none of what it is said to be"));
  EXPECT_THAT(said("functions: {file: acc.uff, responses: [{channel: acc}]}\ncontour: 5\n"),
              HasSubstr("leave contour out"));
  EXPECT_THAT(
      said("functions: {file: acc.uff, sessions: [acc.uff], responses: [{channel: acc}]}\n"),
      HasSubstr("modes are fitted to one session"));
  EXPECT_THAT(
      said("functions: {file: acc.uff, averages: 4, responses: [{channel: acc, coherence: c}]}\n"),
      HasSubstr("leave coherence"));
}

TEST_F(ResponseFunctionsOf, AWindowThatIsTooShortIsRefused) {
  // The first mode decays by 3.8 1/s without the window, by 6.8 with it.
  write_function(3.0);
  const StudyResult result = run_file(
      "functions: {file: acc.uff, responses: [{channel: acc}], exponential_window: 0.1 s}\n"
      "low: 10\nhigh: 190\n");
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.answer, HasSubstr("state a longer exponential_window"));
}

// Lines of a file that divides the responses of the strike of configs/ by its force, both weighted
// by exp(−t/τ): no modes.
class TableOfFunctions : public FolderTest {
 protected:
  static constexpr double kWindow = 0.1;  // τ [s]

  // gain: of a session; noise: relative to the first response's H, for its coherence.
  void write_session(const std::string& name, double gain = 1.0, double coherence = 0.98) const {
    const Recording strike = read_csv(kStructures + "plate_strike.csv");
    const std::size_t count = strike.channels.front().samples.size();
    const RealFft fft(count);
    std::vector<std::vector<Complex>> spectra;
    for (const RecordedChannel& channel : strike.channels) {
      std::vector<double> weighted = channel.samples;
      for (std::size_t j = 0; j < count; ++j) {
        weighted[j] *= std::exp(-static_cast<double>(j) / strike.sample_rate / kWindow);
      }
      spectra.push_back(fft.forward(weighted));
    }
    const double step = strike.sample_rate / static_cast<double>(count);
    const auto lines = static_cast<std::size_t>(700.0 / step);
    std::string text;
    for (std::size_t k = 1; k < spectra.size(); ++k) {
      text += head(fmt::format("h{}", k), 4, 6, lines, step, "m/s2", "N");
      for (std::size_t l = 0; l < lines; ++l) {
        const Complex h = gain * spectra[k][l] / spectra[0][l];
        text += fmt::format("{:20.11E}{:20.11E}\n", h.real(), h.imag());
      }
      text += "    -1\n" + head(fmt::format("c{}", k), 6, 4, lines, step, "NONE", "NONE");
      for (std::size_t l = 0; l < lines; ++l) text += fmt::format("{:20.11E}\n", coherence);
      text += "    -1\n";
    }
    write(name, text);
  }

  // A table of the four responses, and the experiment of the other strike.
  void write_table(const std::string& keys, const std::string& of_response = "") const {
    std::string text = "low: 10 Hz\nhigh: 600 Hz\nfunctions:\n  exponential_window: 0.1 s\n" +
                       keys + "  responses:\n";
    for (int k = 1; k <= 4; ++k) {
      text += fmt::format("  - {{channel: h{}{}}}\n", k,
                          fmt::format(fmt::runtime(of_response), fmt::arg("k", k)));
    }
    write("functions.yaml", text);
    write("force.yaml",
          "kind: identify_force\ntable: functions.yaml\nwindow: 80 ms\nrecord:\n  file: " +
              kStructures + "plate_other_strike.csv\n  force: {channel: force}\n" +
              "  responses: [{channel: a1}, {channel: a2}, {channel: a3}, {channel: a4}]\n");
  }
  StudyResult identified(const std::string& keys = "") const {
    write("with.yaml", content_of(path("force.yaml")) + keys);
    return run(read_yaml_file(path("with.yaml")));
  }

 private:
  static std::string head(const std::string& name, int type, int data, std::size_t lines,
                          double step, const std::string& unit, const std::string& per) {
    std::string text = fmt::format(
        "    -1\n    58\n{}\nNONE\nNONE\nNONE\nNONE\n"
        "{:5}         0    0         0 NONE               1   3 NONE               2   3\n",
        name, type);
    text +=
        fmt::format("{:10}{:10}{:10}{:13.5E}{:13.9f}{:13.5E}\n", data, lines, 1, 0.0, step, 0.0);
    for (const auto& [code, label, stated] : {std::tuple(18, "Frequency", std::string("Hz")),
                                              std::tuple(type == 4 ? 12 : 0, "Ordinate", unit),
                                              std::tuple(type == 4 ? 13 : 0, "Force", per),
                                              std::tuple(0, "NONE", std::string("NONE"))}) {
      text += fmt::format("{:10}{:5}{:5}{:5} {:20} {:20}\n", code, 0, 0, 0, label, stated);
    }
    return text;
  }
};

nlohmann::json force_of(const StudyResult& result) {
  for (const auto& [file, text] : result.files) {
    if (file == "force.json") return nlohmann::json::parse(text)["force"][0];
  }
  throw std::runtime_error("no force");
}

// The plate's table of modes leaves .010 in the band; functions have the noise of a strike on every
// line besides.
TEST_F(TableOfFunctions, FindsTheForceOfAnotherStrike) {
  write_session("monday.uff");
  write_table("  file: monday.uff\n");
  const StudyResult result = identified();
  EXPECT_EQ(result.status, report::Status::kOk) << result.answer;
  const nlohmann::json force = force_of(result);
  EXPECT_EQ(force["shape"], "impacts");
  EXPECT_LT(force["relative_error_in_band"], 0.02);
  // All of it, of which a part stands above 600 Hz.
  EXPECT_LT(force["relative_error"], 0.15);
  EXPECT_GT(force["coverage"], 0.95);
  EXPECT_THAT(result.warnings, testing::Contains(HasSubstr("the table knows no pulse")));
}

// Sessions whose gains differ by 10 % about their mean: a fourth one is off by √(1 + 1/3) of that,
// times Student's t of two degrees of freedom over the normal one, 4.303/1.960. Twelve draws tell a
// deviation to a fifth.
TEST_F(TableOfFunctions, OfSeveralSessionsAreOffAsTheyDiffer) {
  write_session("monday.uff", 0.9);
  write_session("tuesday.uff", 1.0);
  write_session("friday.uff", 1.1);
  write_table("  file: monday.uff\n  sessions: [tuesday.uff, friday.uff]\n");
  const double wide = force_of(identified("shape: smooth\n"))["deviation_n"];
  write_session("monday.uff", 0.999);
  write_session("friday.uff", 1.001);
  const double narrow = force_of(identified("shape: smooth\n"))["deviation_n"];
  double squares = 0.0;
  const Recording strike = read_csv(kStructures + "plate_other_strike.csv");
  for (std::size_t j = 0; j < 320; ++j)
    squares += std::pow(strike.channels[0].samples[j], 2) / 320.0;
  const double expected = 0.1 * std::sqrt(4.0 / 3.0) * 4.303 / 1.960 * std::sqrt(squares);
  EXPECT_NEAR(std::sqrt(wide * wide - narrow * narrow), expected, 0.5 * expected);
  const StructureTable table = read_table(path("functions.yaml"));
  EXPECT_EQ(table.measured.sessions.size(), 3u);
  EXPECT_THAT(table.measured.scatter, ElementsAre(0.0, 0.0, 0.0, 0.0));
  EXPECT_EQ(files_named_by_table(path("functions.yaml")).size(), 3u);
}

TEST_F(TableOfFunctions, ACoherenceTellsTheErrorOfEveryLine) {
  write_session("monday.uff");
  write_table("  file: monday.uff\n  averages: 4\n", ", coherence: c{k}");
  const StructureTable table = read_table(path("functions.yaml"));
  ASSERT_EQ(table.measured.random.size(), 4u);
  EXPECT_NEAR(table.measured.random[2][100], 0.02 / 0.98 / 4.0, 1e-12);
  write_table("  file: monday.uff\n", ", coherence: c{k}");
  EXPECT_THAT(refusal_of([&] { read_table(path("functions.yaml")); }), HasSubstr("state averages"));
  write_table("  file: monday.uff\n  averages: 4\n", ", coherence: h{k}");
  EXPECT_THAT(refusal_of([&] { read_table(path("functions.yaml")); }),
              HasSubstr("\"h1\" is no coherence over even lines"));
  write_session("monday.uff", 1.0, 1.5);
  write_table("  file: monday.uff\n  averages: 4\n", ", coherence: c{k}");
  EXPECT_THAT(refusal_of([&] { read_table(path("functions.yaml")); }),
              HasSubstr("has the value 1.5, which is not between 0 and 1"));
}

TEST_F(TableOfFunctions, IsRefusedForWhatNeedsModesOrDoesNotFit) {
  write_session("monday.uff");
  write_table("  file: monday.uff\n");
  EXPECT_THAT(refusal_of([&] { identified("change: {frequency: 0.3 %}\n"); }),
              HasSubstr("needs modes, measured functions have none"));
  EXPECT_THAT(refusal_of([&] { identified("contour: 5\n"); }),
              HasSubstr("contours of 10 1/s and more, not of 5"));
  write("bow.yaml", "kind: simulate\nstructure: {table: functions.yaml, contact: h1}\n");
  EXPECT_THAT(refusal_of([&] { run(read_yaml_file(path("bow.yaml"))); }), HasSubstr("needs modes"));
  const auto said = [&](const std::string& from, const std::string& to) {
    std::string text = content_of(path("functions.yaml"));
    text.replace(text.find(from), from.size(), to);
    write("other.yaml", text);
    return refusal_of([&] { read_table(path("other.yaml")); });
  };
  EXPECT_THAT(said("high: 600", "high: 900"), HasSubstr("lies above the last line of monday.uff"));
  EXPECT_THAT(said("low: 10", "sensors: [{kind: velocity}]\nlow: 10"),
              HasSubstr("1 sensors for 4 functions"));
  EXPECT_THAT(said("low: 10", "contact: [1]\nlow: 10"), HasSubstr("functions have none"));
}

// Functions do not tell what rang before a record.
TEST_F(TableOfFunctions, OfARecordThatBeginsInTheRingIsRefused) {
  write_session("monday.uff");
  write_table("  file: monday.uff\n");
  std::string text = content_of(path("force.yaml"));
  const std::string file = "plate_other_strike.csv\n";
  text.replace(text.find(file), file.size(), file + "  start: 0.06 s\n");
  write("force.yaml", text);
  const StudyResult result = identified();
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.answer, HasSubstr("do not tell what rang before"));
}

}  // namespace
}  // namespace modcal::response_functions_test
