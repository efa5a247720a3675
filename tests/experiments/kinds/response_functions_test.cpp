// Modes that are fitted to measured response functions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/base/error.hpp"
#include "tests/experiments/kinds/run_document.hpp"
#include "tests/folder_test.hpp"

namespace modcal::response_functions_test {
namespace {

using testing::HasSubstr;

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
    return run_document(read_yaml_file(path("fit.yaml")));
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
      HasSubstr("measurement 2 is one of those before"));
  EXPECT_THAT(said("functions: {file: acc.uff, responses: [{channel: acc}]}\n"
                   "other_strikes: [{file: acc.uff}]\n"),
              HasSubstr("name files of further measurements in functions.sessions"));
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

}  // namespace
}  // namespace modcal::response_functions_test
