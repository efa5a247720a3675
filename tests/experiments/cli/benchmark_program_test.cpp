// Benchmarks from outside: fairness, refusals, a run in which nothing succeeds.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::benchmark_program_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::string_view kHead = R"(kind: benchmark
title: small benchmark
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 8, damping: {type: constant, ratio: 1.5e-2}}
  bow: {position: 31 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 0.1 s
simulator: {type: modal_event}
measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}
model_error: {frequencies: 0.2 %}
inversion: {estimator: one_sided, regularizer: {type: water_level}, parameter_choice: {type: minimal_product}}
calibration:
  parameters: {frequencies: none, contact: false, frequency_range: 1 %, inharmonicity_range: 1e-4}
  objective: spectral_peak
  optimizer: {type: nlopt, algorithm: LN_SBPLX}
  budget: {evaluations: 200}
)";

class BenchmarkProgram : public testing::ProgramTest {
 protected:
  void write_sweep(const std::string& sweep) const {
    write("bench.yaml", std::string(kHead) + "sweep:\n" + sweep);
  }
  // What validate says; plan has to say it, too, and neither may fail for it.
  std::string warnings() const {
    const Outcome validated = modcal("validate bench.yaml");
    EXPECT_EQ(validated.code, 0) << validated.err;
    const Outcome planned = modcal("plan bench.yaml");
    EXPECT_EQ(planned.code, 0) << planned.err;
    EXPECT_EQ(planned.err, validated.err);
    return validated.err;
  }
};

constexpr const char* kTwoOptimizers =
    "    calibration.optimizer: [{type: nlopt, algorithm: LN_SBPLX}, {type: grid, points: 5}]\n";
constexpr const char* kTenSeeds = "    seed: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\n";

TEST_F(BenchmarkProgram, FindsNothingUnfairInAFairComparison) {
  write_sweep(std::string("  product:\n") + kTwoOptimizers + kTenSeeds);
  EXPECT_EQ(warnings(), "");
}

TEST_F(BenchmarkProgram, WarnsAboutTooFewSeeds) {
  write_sweep(std::string("  product:\n") + kTwoOptimizers + "    seed: [1, 2, 3]\n");
  EXPECT_THAT(warnings(), HasSubstr("3 draws a condition tell methods apart only where"));
}

TEST_F(BenchmarkProgram, WarnsAboutDifferentBudgets) {
  write_sweep(
      "  zip:\n"
      "    - calibration.optimizer: [{type: nlopt, algorithm: LN_SBPLX}, {type: grid, points: 5}]\n"
      "      calibration.budget.evaluations: [200, 300]\n"
      "  product:\n" +
      std::string(kTenSeeds));
  EXPECT_THAT(warnings(), HasSubstr("different budgets: what costs more wins"));
}

TEST_F(BenchmarkProgram, WarnsAboutDifferentBounds) {
  write_sweep(
      "  zip:\n"
      "    - calibration.optimizer: [{type: nlopt, algorithm: LN_SBPLX}, {type: grid, points: 5}]\n"
      "      calibration.parameters.frequency_range: [1 %, 0.5 %]\n"
      "  product:\n" +
      std::string(kTenSeeds));
  EXPECT_THAT(warnings(), HasSubstr("different bounds: the narrower range is a head start"));
}

TEST_F(BenchmarkProgram, WarnsAboutDifferentStarts) {
  write_sweep(
      "  zip:\n"
      "    - calibration.optimizer: [{type: nlopt, algorithm: LN_SBPLX}, {type: grid, points: 5}]\n"
      "      model_error.frequencies: [0.2 %, 0.1 %]\n"
      "  product:\n" +
      std::string(kTenSeeds));
  EXPECT_THAT(warnings(), HasSubstr("different starts: errors of another size"));
}

TEST_F(BenchmarkProgram, WarnsAboutDifferentNoise) {
  write_sweep(
      "  zip:\n"
      "    - calibration.optimizer: [{type: nlopt, algorithm: LN_SBPLX}, {type: grid, points: 5}]\n"
      "      measurement.noise_level: [1 %, 2 %]\n"
      "  product:\n" +
      std::string(kTenSeeds));
  const std::string text = warnings();
  EXPECT_THAT(text, HasSubstr("different noise: more of it is another problem"));
  EXPECT_THAT(text, HasSubstr("methods are compared on the problems they share"));
}

TEST_F(BenchmarkProgram, NamesPairsWhoseTasksAreCertainToFailOnce) {
  // 20 points in each of two variables are 400, the budget is 200. A global search that has begun
  // to find the minimum is not meant.
  write_sweep(
      "  product:\n"
      "    calibration.optimizer: [{type: nlopt, algorithm: GN_CRS2_LM}, {type: grid, points: "
      "20}]\n" +
      std::string(kTenSeeds));
  const std::string text = warnings();
  EXPECT_THAT(text,
              HasSubstr("grid 20, spectral_peak: its 10 tasks will all fail: a grid of 20 "
                        "points in each of 2 variables has 400 points, the budget allows 200"));
  EXPECT_THAT(text, Not(HasSubstr("grid 20, spectral_peak does not come half the way")));
  EXPECT_THAT(text, Not(HasSubstr("GN_CRS2_LM, spectral_peak")));
}

TEST_F(BenchmarkProgram, EndsWithSixAndARedReportWhereNothingSucceeds) {
  // Every method is refused: Ceres needs residuals, which this objective does not have.
  write_sweep("  product:\n    calibration.optimizer: [ceres, tiny_least_squares]\n" +
              std::string(kTenSeeds));
  const Outcome outcome = modcal("run bench.yaml --out a");
  EXPECT_EQ(outcome.code, 6) << outcome.err;
  const std::string page = content_of(folder() / "a/report.html");
  EXPECT_THAT(page, HasSubstr("<header class=\"failed\">"));
  EXPECT_THAT(page, HasSubstr("20 of 20 tasks done, 20 failed"));
  // Refusals are rows with their reason, not holes.
  const std::string tasks = content_of(folder() / "a/tasks.csv");
  EXPECT_EQ(std::count(tasks.begin(), tasks.end(), '\n'), 21);
  EXPECT_THAT(tasks, HasSubstr("refused or broke: "));
  EXPECT_EQ(modcal("report a").code, 6);
}

TEST_F(BenchmarkProgram, ScoresAgainstTheBoundAndGivesTheCommandOfEveryPoint) {
  write_sweep(
      "  product:\n    calibration.optimizer: [ceres, {type: nlopt, algorithm: LN_SBPLX}]\n"
      "    measurement.noise_level: [1 %, 2 %]\n    seed: [1, 2, 3]\n");
  const Outcome outcome = modcal("run bench.yaml --out 'my results'");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  const json rows = json::parse(content_of(folder() / "my results/benchmark.json"));
  for (const json& row : rows) {
    if (row["failures"] == 3) continue;
    EXPECT_GT(row["bound"], 0.0);
    EXPECT_NEAR(row["bound_ratio"].get<double>(),
                row["rmse"].get<double>() / row["bound"].get<double>(), 1e-9);
  }
  const std::string page = content_of(folder() / "my results/report.html");
  EXPECT_THAT(page, HasSubstr(R"("replay":"modcal replay 'my results'")"));
  // A point's task runs again.
  const std::size_t place = page.find("data-task=\"");
  ASSERT_NE(place, std::string::npos);
  const std::string task = page.substr(place + 11, page.find('"', place + 11) - place - 11);
  const Outcome replayed = modcal("replay 'my results' " + task);
  EXPECT_EQ(replayed.code, 0) << replayed.err;
}

TEST_F(BenchmarkProgram, RefusesASecondRunInTheSameFolder) {
  write_sweep("  product:\n" + std::string(kTwoOptimizers) + kTenSeeds);
  const Outcome outcome =
      shell("'" MODCAL_PROGRAM
            "' run bench.yaml --out a --set scene.duration='60 s' >first.out 2>&1 & pid=$!; "
            "while ! [ -s a/provenance.json ]; do sleep 0.02; done; "
            "'" MODCAL_PROGRAM
            "' run bench.yaml --out a; code=$?; kill -INT $pid; wait $pid; exit $code");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("another run works in a (process "));
  EXPECT_THAT(outcome.err, HasSubstr("wait for it, stop it or choose another folder with --out"));
}

}  // namespace
}  // namespace modcal::benchmark_program_test
