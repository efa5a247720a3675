// One objective of several records, and what is known beforehand beside it.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "libcalib/calibration.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/objectives/posterior.hpp"
#include "libcalib/optimizers/staged/staged.hpp"
#include "libcalib/problem/covariance.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/likelihood/pluck_record_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::several_records_test {
namespace {

using Names = std::vector<std::string>;

// Two strokes and a pluck of one string, 0.2 s at 2 % of noise.
class SeveralRecordsTest : public testing::Test {
 protected:
  static CalibrationRecord record_of(const NoisyRecords& noisy, bool pluck) {
    return {.data = CalibrationData::of_records(noisy.reactions[0], noisy.reactions[1],
                                                noisy.sample_rate),
            .noise = noisy.deviation,
            .pluck = pluck};
  }
  BowedCase first = bowed_case(0.0285, 1.39e-4, 0.2), second = bowed_case(0.0325, 1.39e-4, 0.2);
  Problem problem{
      .model = first.truth,
      .records = {record_of(noisy(first, 0.02, 5), false), record_of(noisy(second, 0.02, 6), false),
                  record_of(plucked_records(1.39e-4, 0.2, 0.02, 7), true)},
      .parameters = {.frequencies = "all", .law = true, .contact = true},
      .objective = std::make_shared<JointLikelihood>(JointLikelihood::Options{})};

  void SetUp() override { problem.parameters.unknowns.damping = "factor"; }
  BoundProblem bound() const { return bind(problem, Staged(Staged::Options{})); }
  static std::vector<std::string> names_of(const ParameterSet& parameters) {
    std::vector<std::string> names;
    for (const Variable& variable : parameters.variables()) names.push_back(variable.name);
    return names;
  }
  // With the second contact where it is.
  static std::vector<double> truth_of(const ParameterSet& parameters) {
    std::vector<double> x = parameters.start();
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (parameters[i].variable.name == "x_c 2") x[i] = 0.0325;
    }
    return x;
  }

  // Gradient, Jacobian and residuals of a function about x are each other's.
  static void expect_consistent(const ObjectiveFunction& function, const ParameterSet& parameters,
                                const std::vector<double>& x) {
    double value = 0.0;
    std::vector<double> residuals(function.residual_count());
    function.evaluate(x, {.value = &value, .residuals = residuals.data()});
    double sum = 0.0;
    for (const double r : residuals) sum += r * r;
    EXPECT_NEAR(value, 0.5 * sum, 1e-9 * value);
    const std::vector<LeastSquaresSlope> slopes = least_squares_slopes(function, x);
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      // A step whose square's third derivative does not show.
      const double tolerance = 2e-3 * slopes[i].scale;
      EXPECT_NEAR(slopes[i].gradient, slopes[i].quotient, tolerance) << parameters[i].variable.name;
      EXPECT_NEAR(slopes[i].gradient, slopes[i].own, tolerance) << parameters[i].variable.name;
    }
  }
};

TEST_F(SeveralRecordsTest, EachHasForItselfWhatIsItsOwn) {
  problem.parameters.unknowns.sensor[Sensor::kGain] = {.free = true, .value = 1.0};
  problem.parameters.unknowns.per_record = {"x_c", "gain"};
  const BoundProblem all = bound();
  const Names names = names_of(all.parameters);
  // A pluck has no contact, and what one record is blind to is kept for the others.
  EXPECT_EQ(names.size(), 50u + 2u + 1u + 1u + 1u + 3u);
  for (const char* name : {"f_11", "x_c", "x_c 2", "gain", "gain 2", "gain 3"}) {
    EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
  }
  EXPECT_EQ(std::ranges::find(names, "x_c 3"), names.end());
  EXPECT_TRUE(all.blind.empty());
  std::vector<double> x = all.parameters.start();
  x[static_cast<std::size_t>(std::ranges::find(names, "x_c 2") - names.begin())] = 0.0325;
  x[static_cast<std::size_t>(std::ranges::find(names, "gain 3") - names.begin())] = 1.02;
  EXPECT_EQ(all.parameters.model(x, 0).contact, 0.0285);
  EXPECT_EQ(all.parameters.model(x, 1).contact, 0.0325);
  EXPECT_EQ(all.parameters.model(x, 0).sensors.gain, 1.0);
  EXPECT_EQ(all.parameters.model(x, 2).sensors.gain, 1.02);
}

TEST_F(SeveralRecordsTest, ValueIsTheSumOfTheRecords) {
  problem.parameters.frequencies = "none";
  const BoundProblem all = bound();
  EXPECT_EQ(names_of(all.parameters), (Names{"f0", "B", "x_c", "damping", "x_c 2"}));
  double sum = 0.0;
  const double contacts[] = {0.0285, 0.0325};
  for (std::size_t r = 0; r < 2; ++r) {
    const ModelPoint point{first.truth.basis, contacts[r]};
    const ParameterSet one(point, Names{"f0", "B", "x_c", "damping"});
    JointLikelihood::Options options;
    options.left_noise = problem.records[r].noise[0];
    options.right_noise = problem.records[r].noise[1];
    sum += JointLikelihood(options).bind(problem.records[r].data, one)->value(one.start());
  }
  Problem strokes = problem;
  strokes.records.pop_back();
  const BoundProblem two = bind(strokes, Staged(Staged::Options{}));
  EXPECT_DOUBLE_EQ(two.function->value(truth_of(two.parameters)), sum);
  EXPECT_GT(all.function->value(truth_of(all.parameters)), sum);
}

TEST_F(SeveralRecordsTest, SlopesAreDifferenceQuotients) {
  problem.parameters.frequencies = "none";
  problem.parameters.unknowns.sensor[Sensor::kGain] = {.free = true, .value = 1.0};
  problem.parameters.unknowns.per_record = {"x_c", "gain"};
  const BoundProblem all = bound();
  expect_consistent(*all.function, all.parameters, truth_of(all.parameters));
}

TEST_F(SeveralRecordsTest, PriorsJoinIt) {
  UnknownsOptions& unknowns = problem.parameters.unknowns;
  unknowns.sensor[Sensor::kGain] = {.free = true, .value = 1.0};
  unknowns.per_record = {"x_c", "gain"};
  unknowns.priors = {
      {"gain", 1.0, 0.05}, {"gain 2", 1.0, 0.05}, {"f_3", 589.0, 0.2}, {"damping", 1.0, 0.1}};
  unknowns.correlations = {{{"gain", "gain 2"}, 0.5}};
  BoundProblem all = bound();
  const std::size_t before = all.function->residual_count();
  const std::shared_ptr<const ObjectiveFunction> likelihood = std::move(all.function);
  const auto posterior = with_priors(likelihood, all.problem, all.parameters, 2e-3);
  // Four that are stated, and every f_n about the law.
  EXPECT_EQ(posterior->residual_count(), before + 4 + 50);
  std::vector<double> x = truth_of(all.parameters);
  const Names names = names_of(all.parameters);
  const auto at = [&](const char* name) -> double& {
    return x[static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())];
  };
  at("gain") = 1.05;
  at("f_7") *= 1.001;
  // ln 1.05/0.05 of one of two that are correlated by ½: uᵀR⁻¹u = u²/(1 − ¼).
  const double gain = std::log(1.05) / 0.05;
  const double third = std::log(at("f_3") / 589.0) / (0.2 / 589.0);
  const double seventh = std::log(1.001) / 2e-3;
  const double known = gain * gain / 0.75 + third * third + seventh * seventh;
  EXPECT_NEAR(posterior->value(x) - likelihood->value(x), 0.5 * known, 1e-6 * known);
  expect_consistent(*posterior, all.parameters, x);
}

TEST_F(SeveralRecordsTest, WhatIsFixedIsNoParameter) {
  problem.parameters.unknowns.fixed = {{"x_c 2", 0.0325}, {"f_11", 2156.0}, {"B", 1.39e-4}};
  const BoundProblem all = bound();
  const Names names = names_of(all.parameters);
  for (const char* name : {"x_c 2", "f_11", "B"}) {
    EXPECT_EQ(std::ranges::find(names, name), names.end()) << name;
  }
  const std::vector<double> x = all.parameters.start();
  EXPECT_EQ(all.parameters.model(x, 1).contact, 0.0325);
  EXPECT_EQ(all.parameters.model(x, 0).contact, 0.0285);
  EXPECT_DOUBLE_EQ(all.parameters.model(x, 2).basis.frequency(10), 2156.0);
}

TEST_F(SeveralRecordsTest, InformationIsThatOfTheJacobian) {
  problem.parameters.frequencies = "none";
  const BoundProblem all = bound();
  const std::vector<double> x = truth_of(all.parameters);
  const std::vector<double> deviations = deviations_by_information(*all.function, x);
  const Covariance covariance = covariance_at(*all.function, all.parameters.variables(), x);
  for (std::size_t i = 0; i < x.size(); ++i) {
    // Products of far modes are sums over the nodes of a block, good to some 1e-5 of the whole; the
    // Jacobian has one row for all that is known of an end state, some 3e-4 of a record of 0.1 s.
    EXPECT_NEAR(deviations[i], covariance.standard_deviation(i), 5e-4 * deviations[i]);
  }
}

TEST_F(SeveralRecordsTest, WhatNothingTellsHasNoBound) {
  problem.records.resize(1);
  problem.excitation_threshold = 0.0;  // f_n of every mode, so that nothing follows the law
  const BoundProblem one = bound();
  const std::vector<double> deviations =
      deviations_by_information(*one.function, one.parameters.start());
  const Names names = names_of(one.parameters);
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(std::isinf(deviations[i]), names[i] == "f0" || names[i] == "B") << names[i];
  }
}

}  // namespace
}  // namespace modcal::several_records_test
