// Kind "fit_modes" on strikes of a plate that another program has stepped
// (benchmarks/truth/plate.py), and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "experiments/kinds/structure/structure_files.hpp"
#include "tests/experiments/kinds/structure_config.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::fit_modes_test {
namespace {

using structure_config::file_of, structure_config::run;
using testing::HasSubstr;

TEST(FitModes, FindsThePolesOfThePlateWithinTheirErrorBars) {
  const StudyResult result = run("fit_plate.yaml");
  EXPECT_EQ(result.status, report::Status::kOk);
  const auto document = file_of(result, "modes_fit.json");
  // Eigenvalues of the plate's matrices by LAPACK.
  const std::vector<std::pair<double, double>> truth = {
      {32.572045, 0.012923},  {54.833542, 0.014725},  {56.779579, 0.009329},
      {111.725379, 0.002624}, {119.006665, 0.007203}, {178.117182, 0.007196},
      {202.538128, 0.003654}, {231.340090, 0.004474}, {285.457125, 0.005047},
      {338.952940, 0.006255}, {361.534986, 0.005416}, {482.816784, 0.006396},
      {505.635929, 0.008749}, {523.579740, 0.007228}, {535.798262, 0.007075},
      {591.906692, 0.008435}};
  double of_frequencies = 0.0, of_ratios = 0.0;
  for (const auto& [frequency, ratio] : truth) {
    double nearest = 1e9;
    nlohmann::json found;
    for (const auto& mode : document["modes"]) {
      const double off = std::abs(mode["f_hz"].get<double>() - frequency);
      if (off < nearest) nearest = off, found = mode;
    }
    const double f = nearest / found["f_sd_hz"].get<double>();
    const double z = (found["zeta"].get<double>() - ratio) / found["zeta_sd"].get<double>();
    EXPECT_LT(f, 4.0) << frequency;
    EXPECT_LT(std::abs(z), 4.0) << frequency;
    of_frequencies += f * f / 16.0;
    of_ratios += z * z / 16.0;
  }
  // A mean of 16 squares is 1 ± 0.35; neighbors share their errors, and all of them the noise of
  // the force. Bars twice as wide would leave a quarter.
  EXPECT_LT(of_frequencies, 2.4);
  EXPECT_LT(of_ratios, 2.4);
  EXPECT_GT(of_frequencies, 0.4);
  EXPECT_GT(of_ratios, 0.4);
  for (const auto& sensor : document["sensors"]) EXPECT_LT(sensor["left"].get<double>(), 2e-3);
}

// Frequencies (the figure's x) of those that stay when the mode is added that makes `modes`.
std::vector<double> stable_at(const StudyResult& result, std::size_t modes) {
  std::vector<double> frequencies;
  for (const auto& block : result.blocks) {
    const auto* const figure = std::get_if<report::Figure>(&block);
    if (figure == nullptr || figure->id != "stabilization") continue;
    const auto& stable = figure->panels[0].series[1];
    for (std::size_t i = 0; i < stable.x.size(); ++i) {
      if (stable.y[i] == static_cast<double>(modes)) frequencies.push_back(stable.x[i]);
    }
  }
  return frequencies;
}

TEST(FitModes, ModesOfThePlateStayInTheDiagramOfStabilization) {
  const StudyResult result = run("fit_plate.yaml");
  const std::size_t modes = file_of(result, "modes_fit.json")["modes"].size();
  const std::vector<double> stable = stable_at(result, modes);
  // Well separated modes of the plate's matrices, by LAPACK.
  for (const double frequency : {111.725379, 178.117182, 202.538128, 231.340090, 285.457125,
                                 338.952940, 361.534986, 482.816784}) {
    EXPECT_TRUE(std::ranges::any_of(stable, [&](double found) {
      return std::abs(found - frequency) < 2e-3 * frequency;
    })) << frequency;
  }
  // Of the first mode nothing was there before.
  EXPECT_TRUE(stable_at(result, 1).empty());
}

class ExponentialWindow : public FolderTest {};

TEST_F(ExponentialWindow, IsTakenOutOfARecord) {
  write("plain.csv", "t [s],f [N],a [m/s2]\n0,0,0\n0.1,1,2\n0.2,0.5,-3\n0.3,0,1\n");
  std::string text = "t [s],f [N],a [m/s2]\n";
  for (const auto& [time, force, response] :
       {std::tuple(0.0, 0.0, 0.0), std::tuple(0.1, 1.0, 2.0), std::tuple(0.2, 0.5, -3.0),
        std::tuple(0.3, 0.0, 1.0)}) {
    const double left = std::exp(-time / 0.25);
    text += fmt::format("{},{:.17g},{:.17g}\n", time, left * force, left * response);
  }
  write("weighted.csv", text);
  StructureRecordOptions options{.has_force = true, .responses = {{.channel = "a"}}, .start = 0.1};
  options.force.channel = "f";
  const auto loaded = [&](const char* file, double window) {
    options.file = file;
    options.window = window;
    return load_structure_record(options, path("."));
  };
  const LoadedStructureRecord plain = loaded("plain.csv", NAN),
                              other = loaded("weighted.csv", 0.25);
  ASSERT_EQ(other.record.samples(), 3u);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_NEAR(other.record.force[j], plain.record.force[j], 1e-14);
    EXPECT_NEAR(other.record.responses[0][j], plain.record.responses[0][j], 1e-14);
  }
  EXPECT_THAT(refusal_of([&] { loaded("weighted.csv", 0.01); }),
              HasSubstr("has left less than a thousandth"));
}

// What noise is at the end of a weighted record grows by e^6, beyond the strike; that is none the
// less seen.
TEST_F(ExponentialWindow, IsTakenOutBehindTheRest) {
  std::string text = "t [s],a [m/s2]\n";
  constexpr double kWindow = 0.5, kOffset = 0.25;
  for (int j = 0; j < 300; ++j) {
    const double t = 0.01 * j, left = std::exp(-t / kWindow);
    const double moved = j < 40 ? 0.0 : std::exp(-(t - 0.4)) * std::cos(20.0 * (t - 0.4));
    text += fmt::format("{},{:.17g}\n", t, left * (moved + kOffset) + (j % 2 == 0 ? 1e-3 : -1e-3));
  }
  write("weighted.csv", text);
  const LoadedStructureRecord loaded = load_structure_record(
      {.file = "weighted.csv", .responses = {{.channel = "a"}}, .window = kWindow}, path("."));
  EXPECT_LE(loaded.rest, 0.4);
  EXPECT_GE(loaded.rest, 0.2);
  // Noise of .001 is e^.8 as large at the strike.
  EXPECT_NEAR(loaded.record.responses[0][40], 1.0, 0.01);
}

TEST(FitModes, RefusesAForceThatIsNotThatOfTheStrike) {
  const StudyResult result =
      run("fit_plate.yaml", {"record.force.channel=a1", "record.force.calibration=1",
                             "record.responses=[{channel: a2}]"});
  EXPECT_EQ(result.status, report::Status::kFailed);
}

// A half-sine of 2 ms with noise of .02 N, in steps of 1/32768 of 100 N.
class ForceOfABlow : public testing::Test {
 protected:
  static StructureRecord blow(double highest, std::size_t first) {
    StructureRecord record;
    std::mt19937_64 random(1);
    std::normal_distribution<double> noise(0.0, 0.02);
    for (std::size_t i = 0; i < 400; ++i) {
      const double phase = std::numbers::pi * (static_cast<double>(i) - 100.0) / 102.4;
      const bool acts = phase > 0.0 && phase < std::numbers::pi;
      const double force = (acts ? 100.0 * std::sin(phase) : 0.0) + noise(random);
      const double step = 100.0 / 32768.0;
      if (i >= first) record.force.push_back(std::min(highest, step * std::round(force / step)));
    }
    return record;
  }
  static std::string said(const StructureRecord& record) {
    return refusal_of([&] { require_whole_blow(record, "blow.csv"); });
  }
};

TEST_F(ForceOfABlow, MayBeRoundAndBeginAtRest) {
  require_whole_blow(blow(1e3, 0), "blow.csv");
  require_whole_blow(blow(1e3, 102), "blow.csv");  // sin(π 2/102.4) = .06 of its largest
}

TEST_F(ForceOfABlow, IsRefusedClipped) {
  EXPECT_THAT(said(blow(99.0, 0)), HasSubstr("samples of the force from 147 on are 99 N"));
  EXPECT_THAT(said(blow(50.0, 0)), HasSubstr("it is clipped"));
}

TEST_F(ForceOfABlow, IsRefusedWhereItHasBegun) {
  EXPECT_THAT(said(blow(1e3, 120)), HasSubstr("the record begins within the blow"));
}

class ModesOfAUniversalFile : public FolderTest {};

// The force by the universal file that the fit has written, and by its table without what has no
// place there.
TEST_F(ModesOfAUniversalFile, AreThoseOfATable) {
  const StudyResult fit = run("fit_plate.yaml");
  for (const auto& [file, text] : fit.files) write(file, text);
  const StructureTable whole = read_table(path("table.yaml"));
  std::string text = "low: 10\nhigh: 600\nsensors:\n";
  for (const std::string& name : whole.names) {
    text += fmt::format("- {{name: {}, kind: acceleration}}\n", name);
  }
  const std::string sensors = "[1 +3, \"2:+3\", 3 z, 4 +Z]";
  const auto shapes = [&](const std::string& contact, const std::string& places) {
    write("shapes.yaml",
          text + fmt::format("shapes: {{file: modes.uff, contact: {}, sensors: {}}}\n", contact,
                             places));
    return read_table(path("shapes.yaml"));
  };
  const StructureTable read = shapes("5 +3", sensors);
  ASSERT_EQ(read.model.constants.size(), whole.model.constants.size());
  for (std::size_t i = 0; i < read.model.constants.size(); ++i) {
    const Complex a(whole.model.constants[i], whole.model.quadrature[i]);
    const Complex b(read.model.constants[i], read.model.quadrature[i]);
    EXPECT_LT(std::abs(a - b), 1e-4 * std::abs(a)) << i;
  }
  const auto said = [&](const std::string& contact, const std::string& places) {
    return refusal_of([&] { shapes(contact, places); });
  };
  EXPECT_THAT(said("5", sensors), HasSubstr("\"5\" is no node with a direction"));
  EXPECT_THAT(said("9 +3", sensors), HasSubstr("has no node 9"));
  EXPECT_THAT(said("5 +3", "[1 +3]"), HasSubstr("1 places for 4 sensors"));
}

}  // namespace
}  // namespace modcal::fit_modes_test
