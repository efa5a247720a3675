// A table of measured response functions in the place of modes, from the file to the force.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/base/error.hpp"
#include "libsim/records/formats.hpp"
#include "libsim/signal/fft.hpp"
#include "tests/experiments/kinds/run_document.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::table_of_functions_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kStructures = std::string(MODCAL_CONFIGS) + "/structures/";

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
    return run_document(read_yaml_file(path("with.yaml")));
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
  EXPECT_THAT(refusal_of([&] { run_document(read_yaml_file(path("bow.yaml"))); }),
              HasSubstr("needs modes"));
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
}  // namespace modcal::table_of_functions_test
