// Damping and sensors as unknowns, on synthetic truth.
#include "libcalib/parameters/string_unknowns.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/optimizers/staged/newton_fit.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::string_unknowns_test {
namespace {

using std::numbers::pi;

constexpr double kBand = 2.0 * pi * 10300.0;
// Three samples of 1.024 MHz.
constexpr double kDelay = 3.0 / 1.024e6;

// The sensor at x = L reads 1.02 times its reaction, three fine samples late, through a high-pass
// of first order where one is stated.
BowedCase sensed_case(double duration, double corner) {
  constexpr std::size_t kFine = 20;
  Scene scene = paper_scene();
  scene.bow.position = 0.0285;
  scene.string.inharmonicity = 1.39e-4;
  scene.duration = duration;
  const Simulation run = ModalEvent({}).simulate(scene, 51200.0 * kFine,
                                                 {.left_reaction = true, .right_reaction = true});
  const auto& left = run.left_reaction.samples;
  const auto& right = run.right_reaction.samples;
  BowedCase result{.truth = {make_modal_basis(scene.string), 0.0285}};
  result.truth.sensors = {.gain = 1.02, .delay = kDelay, .corner = corner};
  // y' = R' − corner y, trapezoidal steps of the fine rate.
  const double half = 0.5 * corner / (51200.0 * kFine);
  double filtered = 0.0;
  for (std::size_t j = 0; j < left.size(); ++j) {
    const double now = j >= 3 ? right[j - 3] : 0.0;
    const double before = j >= 4 ? right[j - 4] : 0.0;
    filtered = ((1.0 - half) * filtered + now - before) / (1.0 + half);
    if (j % kFine != 0) continue;
    result.clean[0].push_back(left[j]);
    result.clean[1].push_back(1.02 * filtered);
  }
  for (std::size_t r = 0; r < 2; ++r) {
    remove_mean(result.clean[r]);
    result.spread[r] = standard_deviation(result.clean[r]);
  }
  return result;
}

UnknownsOptions free_sensors(bool corner) {
  UnknownsOptions options;
  options.sensor[Sensor::kGain].free = true;
  options.sensor[Sensor::kDelay].free = true;
  options.sensor[Sensor::kCorner].free = corner;
  return options;
}

TEST(StringUnknowns, GradientOfEveryUnknownIsTheDifferenceQuotient) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.1);
  ModelPoint off = bowed.truth;
  off.sensors = {.gain = 1.01, .delay = 1e-6, .corner = 2.0 * pi * 3.0};
  for (double& omega : off.basis.omega) omega *= 1.0 + 5e-5;
  for (const std::string damping : {"power", "each"}) {
    UnknownsOptions options = free_sensors(true);
    options.damping = damping;
    const StringUnknowns unknowns = StringUnknowns::frequencies(off, options);
    const Eigen::VectorXd start = unknowns.start();
    for (const double sigma : {0.0, 40.0}) {
      const ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.02, 3), sigma, kBand));
      const LikelihoodPoint at = likelihood.evaluate(off, unknowns.columns(start));
      for (Eigen::Index i = unknowns.damping(); i < unknowns.size(); ++i) {
        // A hundredth of a standard deviation, all else known, or less.
        const double size = std::sqrt(at.information(i, i));
        const double step = std::min(1e-2 / size, 1e-3);
        Eigen::VectorXd above = start, below = start;
        above[i] += step;
        below[i] -= step;
        const double quotient =
            (likelihood.cost(unknowns.model(above)) - likelihood.cost(unknowns.model(below))) /
            (2.0 * step);
        EXPECT_NEAR(2.0 * at.slope[i], quotient, 2e-3 * size * std::sqrt(at.cost))
            << damping << ", unknown " << i << ", sigma " << sigma;
      }
    }
  }
}

// Six standard deviations, as in the Monte Carlo studies.
void expect_sensors(const ContinuationResult& result, const Sensor& truth, bool corner) {
  EXPECT_TRUE(result.right) << result.chi2;
  const Sensor& found = result.model.sensors;
  const auto& sd = result.sensor_deviation;
  EXPECT_LT(std::abs(found.gain - truth.gain), 6.0 * sd[0]) << found.gain;
  EXPECT_LT(std::abs(found.delay - truth.delay), 6.0 * sd[1]) << found.delay;
  EXPECT_LT(sd[0], 2e-3);
  EXPECT_LT(sd[1], 1e-6);
  if (corner) {
    EXPECT_LT(std::abs(found.corner - truth.corner), 6.0 * 2.0 * pi * sd[2]) << found.corner;
    EXPECT_LT(sd[2], 1.0);
  }
}

TEST(StringUnknowns, GainDelayAndCornerAreFound) {
  for (const double corner : {0.0, 2.0 * pi * 4.0}) {
    const BowedCase sensed = sensed_case(0.5, corner);
    const NoisyRecords records = noisy(sensed, 0.01, 9);
    const CalibrationData data = CalibrationData::of_records(
        records.reactions[0], records.reactions[1], records.sample_rate);
    ModelPoint start = sensed.truth;
    start.sensors = {};
    for (double& omega : start.basis.omega) omega *= 1.005;
    start.contact += 5e-4;
    ContinuationOptions options{.law_width = 2e-3,
                                .left_noise = records.deviation[0],
                                .right_noise = records.deviation[1],
                                .restarts = 0};
    EXPECT_FALSE(calibrate_by_continuation(start, data, options).right);
    options.unknowns = free_sensors(corner > 0.0);
    const ContinuationResult result = calibrate_by_continuation(start, data, options);
    expect_sensors(result, sensed.truth.sensors, corner > 0.0);
    EXPECT_LT(std::abs(result.law.contact - 0.0285), 6.0 * result.law.deviation[2]);
  }
}

TEST(StringUnknowns, APriorHoldsWhatTheDataDoNotTell) {
  const BowedCase sensed = sensed_case(0.25, 0.0);
  const NoisyRecords records = noisy(sensed, 0.02, 4);
  const ProjectedLikelihood whole(WhitenedRecord::of(records, 0.0, kBand));
  ModelPoint start = sensed.truth;
  start.sensors = {};
  UnknownsOptions options = free_sensors(false);
  options.priors = {{.parameter = "gain", .mean = 1.0, .deviation = 1e-7}};
  const StringUnknowns held =
      StringUnknowns::law(start, 196.0, 1.39e-4, options, StatedPriors(options, start));
  const QuadraticPrior prior = held.prior(held.start());
  const NewtonFit fit =
      newton_fit(whole, held, held.start(), {.prior = prior.precision, .prior_mean = prior.mean});
  EXPECT_NEAR(held.model(fit.theta).sensors.gain, 1.0, 1e-5);
}

TEST(StringUnknowns, ALawOfDampingIsFound) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.5);
  const NoisyRecords records = noisy(bowed, 0.01, 6);
  const ProjectedLikelihood whole(WhitenedRecord::of(records, 0.0, kBand));
  ModelPoint start = bowed.truth;
  for (std::size_t n = 0; n < 50; ++n) {
    start.basis.zeta[n] *= 1.2 * std::pow(static_cast<double>(n + 1), -0.1);
  }
  const StringUnknowns factor = StringUnknowns::law(start, 196.0, 1.39e-4);
  const StringUnknowns power = StringUnknowns::law(start, 196.0, 1.39e-4, {.damping = "power"});
  const NewtonFit poor = newton_fit(whole, factor, factor.start(), {});
  const NewtonFit good = newton_fit(whole, power, power.start(), {});
  const Eigen::VectorXd sd = (2.0 * good.point.information).inverse().diagonal().cwiseSqrt();
  const Eigen::Index at = power.damping();
  EXPECT_LT(std::abs(good.theta[at] - std::log(1.0 / 1.2)), 6.0 * sd[at]);
  EXPECT_LT(std::abs(good.theta[at + 1] - 0.1), 6.0 * sd[at + 1]);
  // χ² knows the difference: nine and more for one unknown.
  EXPECT_GT(2.0 * (poor.objective - good.objective), 9.0);
}

}  // namespace
}  // namespace modcal::string_unknowns_test
