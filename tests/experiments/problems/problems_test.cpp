// Calibrations as functions of the C library, and SciPy on one of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <thread>

#include "experiments/problems/modcal_problems.h"
#include "tests/experiments/cli/program_run.hpp"

namespace modcal::problems_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kCalibrate = R"(kind: calibrate
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, inharmonicity: 1e-4, modes: 12, damping: {type: constant, ratio: 3e-3}}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  duration: 0.2 s
simulator: modal_event
measurement: {sample_rate: 12.8 kHz, noise_level: 1 %}
model_error: {contact: 0.4 mm}
calibration: {objective: joint_likelihood, optimizer: gsl, parameters: {frequencies: none, law: true, contact: true}}
)";

constexpr const char* kRecord = R"(kind: calibrate
record: {file: )" MODCAL_EXAMPLES R"(/bowed_violin_d.csv, left: {channel: R1}, right: {channel: R2}}
string: {length: 0.33 m, linear_density: 1e-3 kg/m, fundamental: 294 Hz, inharmonicity: 1.1e-4, modes: 30, damping: {type: constant, ratio: 1e-3}}
bow: {position: 41 mm}
calibration: {objective: joint_likelihood, optimizer: gsl, parameters: {frequencies: none, law: true, contact: true}}
)";

class Problems : public testing::ProgramTest {
 protected:
  void SetUp() override { write("calibrate.yaml", kCalibrate); }
  ~Problems() override { modcal_problem_close(problem_); }
  modcal_problem* open(std::vector<const char*> assignments = {}) {
    modcal_problem_close(problem_);
    problem_ =
        modcal_problem_open(path("calibrate.yaml").c_str(), assignments.data(), assignments.size());
    return problem_;
  }

 private:
  modcal_problem* problem_ = nullptr;
};

TEST_F(Problems, HaveNamesBoundsStartTruthAndBound) {
  const modcal_problem* problem = open();
  ASSERT_NE(problem, nullptr) << modcal_problem_message();
  ASSERT_EQ(modcal_problem_dimension(problem), 3u);
  EXPECT_STREQ(modcal_problem_name(problem, 0), "f0");
  EXPECT_STREQ(modcal_problem_unit(problem, 2), "m");
  EXPECT_EQ(modcal_problem_name(problem, 3), nullptr);
  double lower[3], upper[3], start[3], truth[3], bound[3];
  modcal_problem_bounds(problem, lower, upper);
  modcal_problem_start(problem, start);
  ASSERT_EQ(modcal_problem_truth(problem, truth), 0) << modcal_problem_message();
  ASSERT_EQ(modcal_problem_bound(problem, bound), 0) << modcal_problem_message();
  EXPECT_NEAR(truth[0], 196.0, 1e-9);
  EXPECT_NEAR(start[2], 0.0304, 1e-12);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(lower[i], truth[i]);
    EXPECT_LT(truth[i], upper[i]);
    EXPECT_GT(bound[i], 0.0);
  }
}

// Central differences over h are wrong by h² f'''/6; over 1e-4 of a scale that is below 1e-3 of a
// slope away from the optimum, as the values of the residuals have curvatures of that scale.
TEST_F(Problems, SlopesAreThoseOfTheValueFromEveryThread) {
  const modcal_problem* problem = open();
  ASSERT_NE(problem, nullptr) << modcal_problem_message();
  double x[3], scale[3], gradient[3];
  modcal_problem_start(problem, x);
  modcal_problem_scale(problem, scale);
  ASSERT_EQ(modcal_problem_gradient(problem, x, gradient), 0) << modcal_problem_message();
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&, i] {
      double at[3] = {x[0], x[1], x[2]}, above = 0.0, below = 0.0;
      at[i] = x[i] + 1e-4 * scale[i];
      EXPECT_EQ(modcal_problem_value(problem, at, &above), 0);
      at[i] = x[i] - 1e-4 * scale[i];
      EXPECT_EQ(modcal_problem_value(problem, at, &below), 0);
      EXPECT_NEAR((above - below) / (2e-4 * scale[i]) / gradient[i], 1.0, 1e-3) << i;
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST_F(Problems, SayWhatIsWrongWithItsPlace) {
  EXPECT_EQ(open({"calibration.optimiser=gsl"}), nullptr);
  EXPECT_THAT(modcal_problem_message(), HasSubstr("did you mean \"optimizer\"?"));
  write("calibrate.yaml", "kind: simulate\n");
  EXPECT_EQ(open(), nullptr);
  EXPECT_THAT(modcal_problem_message(), HasSubstr("calibrate.yaml:"));
  write("calibrate.yaml", kRecord);
  const modcal_problem* problem = open();
  ASSERT_NE(problem, nullptr) << modcal_problem_message();
  double numbers[3];
  EXPECT_EQ(modcal_problem_truth(problem, numbers), 1);
  EXPECT_EQ(modcal_problem_bound(problem, numbers), 1);
  EXPECT_THAT(modcal_problem_message(), HasSubstr("there is no bound"));
}

// The records tell no more by another objective.
TEST_F(Problems, HaveOneBoundWhateverTheirObjective) {
  double bounds[3][3];
  const char* objectives[] = {"calibration.objective=joint_likelihood",
                              "calibration.objective=contact_location_squares",
                              "calibration.objective=innovation_misfit"};
  for (int i = 0; i < 3; ++i) {
    const modcal_problem* problem = open({objectives[i], "calibration.optimizer=nlopt"});
    ASSERT_NE(problem, nullptr) << modcal_problem_message();
    ASSERT_EQ(modcal_problem_bound(problem, bounds[i]), 0) << modcal_problem_message();
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(bounds[1][i], bounds[0][i]);
    EXPECT_DOUBLE_EQ(bounds[2][i], bounds[0][i]);
  }
  double none[3];
  ASSERT_EQ(modcal_problem_bound(open({"measurement.noise_level=0"}), none), 0);
  for (const double one : none) EXPECT_EQ(one, 0.0);
}

TEST_F(Problems, MayBeOfSeveralRecords) {
  const modcal_problem* problem =
      open({"calibration.optimizer=staged", "further_strokes.contacts=[33 mm]",
            "plucks=[{initial: {type: pluck, position: 43 mm, displacement: 1 mm, width: 3 mm}, "
            "duration: 0.2 "
            "s, sample_rate: 12.8 kHz}]"});
  ASSERT_NE(problem, nullptr) << modcal_problem_message();
  ASSERT_EQ(modcal_problem_dimension(problem), 4u);
  EXPECT_STREQ(modcal_problem_name(problem, 3), "x_c 2");
  double start[4], truth[4], bound[4], at_start = 0.0, at_truth = 0.0;
  modcal_problem_start(problem, start);
  ASSERT_EQ(modcal_problem_truth(problem, truth), 0) << modcal_problem_message();
  ASSERT_EQ(modcal_problem_bound(problem, bound), 0) << modcal_problem_message();
  EXPECT_DOUBLE_EQ(truth[3], 0.033);
  for (const double one : bound) EXPECT_TRUE(one > 0.0 && std::isfinite(one));
  ASSERT_EQ(modcal_problem_value(problem, start, &at_start), 0) << modcal_problem_message();
  ASSERT_EQ(modcal_problem_value(problem, truth, &at_truth), 0) << modcal_problem_message();
  EXPECT_LT(at_truth, at_start);
}

// SciPy's search by the example ends where the data put the optimum: within 4.5 bounds of the truth
// for each of three numbers, which noise exceeds once in 50 000.
TEST_F(Problems, TheExampleWithSciPyFindsTheTruth) {
  const std::string said =
      shell("/usr/bin/python3 '" MODCAL_EXAMPLES "/problems_for_scipy.py' '" MODCAL_PROBLEMS
            "' calibrate.yaml 2>&1")
          .out;
  const std::regex line("([A-Za-z0-9_]+) = .*, (-?[0-9.]+) deviations from the truth");
  int found = 0;
  for (std::sregex_iterator at(said.begin(), said.end(), line), end; at != end; ++at, ++found) {
    EXPECT_LT(std::abs(std::stod((*at)[2])), 4.5) << (*at)[0];
  }
  EXPECT_EQ(found, 3) << said;
}

}  // namespace
}  // namespace modcal::problems_test
