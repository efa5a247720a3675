#include <gtest/gtest.h>

#include <cmath>

#include "libinverse/model_based/friction_curve.hpp"
#include "libinverse/model_based/model_based_estimator.hpp"
#include "libsim/base/error.hpp"
#include "libsim/dynamics/friction/hyperbolic.hpp"
#include "tests/libinverse/model_based/bowed_record.hpp"

namespace modcal {
namespace {

// Samples on a known curve, once for each direction of the bow: medians and quantiles of a cell lie
// within what the curve changes over the cell's width.
TEST(FrictionCurve, FindsTheCurveBehindTheSamples) {
  for (const double bow : {0.1, -0.1}) {
    std::vector<double> velocity, force;
    for (int i = 0; i < 4000; ++i) {
      const double slip = 0.9 * (i + 0.5) / 4000;
      velocity.push_back(bow > 0.0 ? bow - slip : bow + slip);
      force.push_back((bow > 0.0 ? 1.0 : -1.0) * (0.2 + 0.2 * std::exp(-5.0 * slip)));
    }
    const auto curve = observer::friction_curve(velocity, force, bow, 20);
    ASSERT_EQ(curve.size(), 20u);
    for (const auto& cell : curve) {
      const double expected = 0.2 + 0.2 * std::exp(-5.0 * cell.speed);
      // The first cell lacks the slips below 2 % of the largest, 0.018 of its 0.045 m/s.
      const double shift = cell.speed < 0.045 ? 0.009 : 0.1 * 0.045;
      EXPECT_NEAR(cell.median, expected, shift * 5.0 * 0.2);
      EXPECT_LE(cell.low, cell.median);
      EXPECT_GE(cell.high, cell.median);
      EXPECT_LE(cell.high - cell.low, 0.045 * 5.0 * 0.2);
    }
  }
}

TEST(FrictionCurve, RefusesWhatIsNoPair) {
  const std::vector<double> three(3, 0.0), two(2, 0.0);
  EXPECT_THROW(observer::friction_curve(three, two, 0.1, 5), InvalidInput);
  EXPECT_THROW(observer::friction_curve(three, three, 0.0, 5), InvalidInput);
  EXPECT_THROW(observer::friction_curve(three, three, 0.1, 0), InvalidInput);
}

ModelBasedResult compare_laws(const Choice<FrictionLaw>& law, double noise) {
  BowedRecord record = bowed_record(0.15, 0.0);
  record.scene.friction = law;
  record.truth = ModalEvent({}).simulate(record.scene, kRecordRate, OutputRequest::all());
  Measurement measurement;
  measurement.noise_level = noise;
  record.left = measure(record.truth.left_reaction, measurement, StreamKey(1).with("R1"));
  record.right = measure(record.truth.right_reaction, measurement, StreamKey(1).with("R2"));
  ModelBasedOptions options;
  options.substeps = 4;
  options.rounds = 0;
  options.laws = {"exponential", "hyperbolic"};
  return ModelBasedEstimator(options).estimate(record.basis, record.scene.bow.position, kRecordRate,
                                               record.left.samples, record.right.samples);
}

// The round trip: each law is told from the other by the reactions of 0.15 s.
TEST(FrictionCandidates, TheLawThatMadeTheRecordIsNamed) {
  const ModelBasedResult exponential =
      compare_laws(Choice<FrictionLaw>("coulomb_exponential"), 0.02);
  ASSERT_EQ(exponential.laws.size(), 2u);
  EXPECT_EQ(exponential.laws[0].law, "exponential");
  EXPECT_GT(exponential.laws[1].criterion, exponential.laws[0].criterion + 20.0);
  Hyperbolic::Options options;
  options.half_speed = 0.1;
  const ModelBasedResult hyperbolic =
      compare_laws(Choice<FrictionLaw>::of<Hyperbolic>("hyperbolic", options), 0.02);
  EXPECT_EQ(hyperbolic.laws[0].law, "hyperbolic");
  EXPECT_GT(hyperbolic.laws[1].criterion, hyperbolic.laws[0].criterion + 20.0);
  // 1/v₀.
  EXPECT_NEAR(hyperbolic.parameters.sliding.decay, 10.0, 2.0);
}

TEST(FrictionCandidates, UnknownLawsAreRefused) {
  ModelBasedOptions options;
  options.laws = {"parabolic"};
  EXPECT_THROW(ModelBasedEstimator{options}, InvalidInput);
  options.laws = {};
  EXPECT_THROW(ModelBasedEstimator{options}, InvalidInput);
}

}  // namespace
}  // namespace modcal
