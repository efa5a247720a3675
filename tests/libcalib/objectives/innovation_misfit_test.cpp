#include "libcalib/objectives/innovation_misfit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/optimizers/tiny_least_squares.hpp"
#include "libcalib/problem/covariance.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/measurement.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::innovation_misfit_test {
namespace {

using Names = std::vector<std::string>;

struct Case {
  BowedRecord record = bowed_record(0.08, 0.02);
  CalibrationData data =
      CalibrationData::of_records(record.left.samples, record.right.samples, kRecordRate);
  ModelPoint truth{record.basis, record.scene.bow.position};
};

const Case& the_case() {
  static const Case value;
  return value;
}

TEST(InnovationMisfit, IsNearOneAtTheTruthAndRisesAwayFromIt) {
  const Case& given = the_case();
  const ParameterSet parameters(given.truth, Names{"x_c", "f0"});
  const auto function = InnovationMisfit(InnovationMisfit::Options{}).bind(given.data, parameters);
  const auto x = parameters.start();
  const auto samples = static_cast<double>(given.data.samples);
  const double truth = function->value(x) / samples;
  // White innovations give 1 ± 0.016; one gain for the whole record lets some of the force's noise
  // through that it allows for.
  EXPECT_GT(truth, 0.95);
  EXPECT_LT(truth, 1.35);
  for (const double shift : {-1e-4, 1e-4}) {
    EXPECT_GT(function->value(std::vector<double>{x[0] + shift, x[1]}) / samples, 1.5 * truth);
  }
  for (const double share : {0.999, 1.001}) {
    EXPECT_GT(function->value(std::vector<double>{x[0], x[1] * share}) / samples, 1.5 * truth);
  }
}

TEST(InnovationMisfit, HasItsValueAsResiduals) {
  const Case& given = the_case();
  const ParameterSet parameters(given.truth, Names{"x_c"});
  const auto function = InnovationMisfit({.iterations = 0}).bind(given.data, parameters);
  EXPECT_TRUE(function->capabilities().sum_of_squares());
  EXPECT_FALSE(function->capabilities().gradient);
  std::vector<double> r(function->residual_count());
  double value = 0.0;
  function->evaluate(parameters.start(), {.value = &value, .residuals = r.data()});
  EXPECT_EQ(r.size(), 2 * given.data.samples);
  // Sums of 8192 terms in another order.
  EXPECT_NEAR(0.5 * std::inner_product(r.begin(), r.end(), r.begin(), 0.0), value, 1e-11 * value);
  EXPECT_EQ(function->value(parameters.start()), value);
}

constexpr double kGain = 1.04, kDelay = 8e-6, kCorner = 3.0;

// What a sensor of that gain, delay and corner reads of a reaction that begins at rest; the
// high-pass exact for a reaction that is linear between its samples.
Signal read_by(const Signal& reaction, double gain, double delay, double corner) {
  const double rate = reaction.sample_rate;
  const double turn = 2.0 * std::numbers::pi * corner / rate;
  const double decay = std::exp(-turn), share = -std::expm1(-turn) / turn;
  Signal reading = reaction;
  reading.samples = advanced(reaction.samples, -delay, rate);
  double last = 0.0, passed = 0.0;
  for (double& sample : reading.samples) {
    passed = decay * passed + share * (sample - last);
    last = sample;
    sample = gain * passed;
  }
  return reading;
}

TEST(InnovationMisfit, FindsLawContactDampingAndSensorAtOnce) {
  BowedRecord record = light_record(0.06, 0.02);
  record.truth.right_reaction = read_by(record.truth.right_reaction, kGain, kDelay, kCorner);
  measure_again(record, 0.02);
  const CalibrationData data =
      CalibrationData::of_records(record.left.samples, record.right.samples, record.rate);
  ModelPoint initial{record.basis, record.scene.bow.position + 0.3e-3};
  for (std::size_t n = 0; n < initial.basis.size(); ++n) {
    initial.basis.omega[n] *= 1.001;
    initial.basis.zeta[n] *= 1.2;
  }
  const Names names{"f0", "B", "x_c", "damping", "gain", "delay", "corner"};
  ParameterRanges ranges{.frequency = 0.004, .inharmonicity = 1e-5, .contact = 1e-3};
  ranges.sensors[Sensor::kDelay] = 2e-5;
  ranges.sensors[Sensor::kCorner] = 10.0;
  const ParameterSet parameters(initial, names, ranges);
  const auto function = InnovationMisfit(InnovationMisfit::Options{}).bind(data, parameters);
  const auto result =
      TinyLeastSquares({}).minimize(*function, parameters.variables(), {.evaluations = 84});
  ASSERT_EQ(function->residual_count() % 2, 0u);
  EXPECT_LT(function->residual_count(), 2 * data.samples);  // the delay's reach is left out
  EXPECT_GT(result.initial_value, 5.0 * result.value);

  const ModelPoint true_model{
      record.basis, record.scene.bow.position, {kGain, kDelay, 2.0 * std::numbers::pi * kCorner}};
  const ParameterSet at_truth(true_model, names);
  const Covariance bound = covariance_at(*JointLikelihood({}).bind(data, at_truth),
                                         at_truth.variables(), at_truth.start());
  const std::vector<double> start = parameters.start();
  const double position = record.scene.bow.position;
  const std::vector<double> truth{196.0, 0.0, position, 1.0 / 1.2, kGain, kDelay, kCorner};
  for (std::size_t i = 0; i < names.size(); ++i) {
    // The bound that does not know the friction law, and so has less to go by; 4 of its standard
    // deviations for one gain and Huber's ρ, which are not efficient.
    const double tolerance = 4.0 * bound.standard_deviation(i);
    EXPECT_NEAR(result.x[i], truth[i], tolerance) << names[i];
    // What starts off is found, not kept.
    if (names[i] != "B") {
      EXPECT_GT(std::abs(start[i] - truth[i]), 1.5 * tolerance) << names[i];
    }
  }
}

TEST(InnovationMisfit, RefusesADelayThatReachesBeyondTheRecord) {
  const Case& given = the_case();
  ParameterRanges ranges;
  ranges.sensors[Sensor::kDelay] = 0.05;
  const ParameterSet parameters(given.truth, Names{"x_c", "delay"}, ranges);
  EXPECT_THROW(InnovationMisfit({.iterations = 0}).bind(given.data, parameters), InvalidInput);
}

TEST(InnovationMisfit, RefusesWhatItCannotPredict) {
  EXPECT_THROW(InnovationMisfit({.substeps = 0}), InvalidInput);
  EXPECT_THROW(InnovationMisfit({.force_noise = 0.0}), InvalidInput);
  Case given = the_case();
  given.data.reactions[0].clear();
  const ParameterSet parameters(given.truth, Names{"x_c"});
  EXPECT_THROW(InnovationMisfit(InnovationMisfit::Options{}).bind(given.data, parameters),
               InvalidInput);
}

}  // namespace
}  // namespace modcal::innovation_misfit_test
