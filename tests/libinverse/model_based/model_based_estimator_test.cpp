#include "libinverse/model_based/model_based_estimator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/gestures/sine_gesture.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libinverse/model_based/bowed_record.hpp"

namespace modcal {
namespace {

ModelBasedOptions quick() {
  ModelBasedOptions options;
  options.substeps = 4;
  options.rounds = 1;
  return options;
}

ModelBasedResult estimate(const BowedRecord& r, const ModelBasedOptions& options,
                          double contact_error = 0.0) {
  return ModelBasedEstimator(options).estimate(r.basis, r.scene.bow.position + contact_error,
                                               kRecordRate, r.left.samples, r.right.samples);
}

// A short record at 2 % noise, nothing of the truth used. The limits hold two thirds of the
// distance between what was measured (velocity 0.9999, force 0.98, parameters within 2 %) and what
// a linear estimate reaches (0.84).
TEST(ModelBasedEstimator, RecoversForceAndFrictionLaw) {
  const BowedRecord r = bowed_record(0.2, 0.02);
  const ModelBasedResult result = estimate(r, quick());
  EXPECT_GT(correlation(result.force, r.truth.force.samples), 0.95);
  EXPECT_GT(correlation(result.velocity, r.truth.velocity.samples), 0.999);
  EXPECT_LT(correlation(result.linear_force, r.truth.force.samples), 0.93);
  const observer::ObserverParameters& p = result.parameters;
  EXPECT_NEAR(p.sliding.dynamic_force, 0.2, 0.02);
  EXPECT_NEAR(p.sliding.force_drop, 0.2, 0.01);
  EXPECT_NEAR(p.sliding.decay, 5.0, 0.4);
  EXPECT_NEAR(p.bow_velocity, 0.1, 5e-4);
  EXPECT_NEAR(p.stiffness, 1e5, 1e4);
  EXPECT_NEAR(result.static_part.level, mean(r.truth.force.samples),
              5.0 * result.static_part.deviation);
  // The transient, a third of this record, is followed less closely than steady motion.
  EXPECT_NEAR(result.misfit, 1.0, 0.15);
  EXPECT_NEAR(result.steady_misfit, result.expected_misfit, 4.0 * result.misfit_deviation);
  EXPECT_LT(result.misfit_deviation, 0.03);
  EXPECT_TRUE(result.warnings.empty());
  // 95 % bands of one record, whose samples are no independent draws.
  const auto share_inside = [](const std::vector<double>& x, const std::vector<double>& truth,
                               const std::vector<double>& deviation, double shift) {
    std::size_t inside = 0, all = 0;
    for (std::size_t k = x.size() / 2; k < x.size(); ++k, ++all) {
      if (std::abs(x[k] + shift - truth[k]) <= 1.96 * deviation[k]) ++inside;
    }
    return static_cast<double>(inside) / static_cast<double>(all);
  };
  const double shift = mean(r.truth.force.samples) - result.static_part.level;
  const double of_force =
      share_inside(result.force, r.truth.force.samples, result.force_deviation, shift);
  const double of_velocity =
      share_inside(result.velocity, r.truth.velocity.samples, result.velocity_deviation, 0.0);
  for (const double share : {of_force, of_velocity}) {
    EXPECT_GT(share, 0.88);
    EXPECT_LT(share, 0.99);
  }
}

TEST(ModelBasedEstimator, SaysThatTheModelIsWrong) {
  const BowedRecord r = bowed_record(0.08, 0.02);
  const ModelBasedResult result = estimate(r, quick(), 2e-3);
  EXPECT_GT(result.misfit, 1.3);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings[0].find("innovation misfit"), std::string::npos);
}

TEST(ModelBasedEstimator, ABowMovingBackGivesTheMirrorImage) {
  BowedRecord r = bowed_record(0.06, 0.02);
  const ModelBasedResult forward = estimate(r, quick());
  for (Signal* signal : {&r.left, &r.right}) {
    for (double& value : signal->samples) value = -value;
  }
  const ModelBasedResult back = estimate(r, quick());
  EXPECT_FALSE(forward.negated);
  EXPECT_TRUE(back.negated);
  for (std::size_t k = 0; k < forward.force.size(); ++k) {
    ASSERT_EQ(back.force[k], -forward.force[k]) << k;
    ASSERT_EQ(back.velocity[k], -forward.velocity[k]) << k;
  }
}

TEST(ModelBasedEstimator, SameBitsForAnyNumberOfThreads) {
  const BowedRecord r = bowed_record(0.05, 0.02);
  const ModelBasedResult several = estimate(r, quick());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ModelBasedResult alone = estimate(r, quick());
  EXPECT_EQ(several.force, alone.force);
  EXPECT_EQ(several.misfit, alone.misfit);
}

// The left sensor 2 % too sensitive: freed, the ratio is found.
TEST(ModelBasedEstimator, FindsTheGainOfASensor) {
  BowedRecord r = bowed_record(0.12, 0.01);
  for (double& value : r.left.samples) value *= 1.02;
  ModelBasedOptions options = quick();
  options.gain = true;
  const ModelBasedResult result = estimate(r, options);
  EXPECT_NEAR(result.parameters.gain, 1.02, 0.004);
}

// Over six draws of noise the static level is off by what its deviation says: rms of the ratios 1,
// within the factor that six draws leave (χ²₆ at 0.5 and 99.5 %: 0.34 to 1.76).
TEST(ModelBasedEstimator, SaysHowFarTheStaticPartIsRecovered) {
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const BowedRecord r = bowed_record(0.1, 0.05, seed);
    ModelBasedOptions options = quick();
    options.rounds = 0;
    const ModelBasedResult result = estimate(r, options);
    const double off = result.static_part.level - mean(r.truth.force.samples);
    sum += off * off / (result.static_part.deviation * result.static_part.deviation);
  }
  EXPECT_GT(std::sqrt(sum / 6.0), 0.34);
  EXPECT_LT(std::sqrt(sum / 6.0), 1.76);
}

// The bow's velocity swings by ±5 %, once in 0.2 s. Held constant, the estimate warns; with a knot
// at every quarter it follows as closely as lines between five knots do: the least-squares ones
// have the knots 0.098, 1.191, 0, -1.191, -0.098 times the swing.
TEST(ModelBasedEstimator, FollowsABowVelocityThatDrifts) {
  BowedRecord r = bowed_record(0.2, 0.02);
  SineGesture::Options swing;
  swing.amplitude = 0.05;
  swing.frequency = 5.0;
  r.scene.bow.velocity_gesture = Choice<Gesture>::of<SineGesture>("sine", swing);
  r.truth = ModalEvent({}).simulate(r.scene, kRecordRate, OutputRequest::all());
  Measurement measurement;
  measurement.noise_level = 0.02;
  r.left = measure(r.truth.left_reaction, measurement, StreamKey(1).with("R1"));
  r.right = measure(r.truth.right_reaction, measurement, StreamKey(1).with("R2"));
  const ModelBasedResult constant = estimate(r, quick());
  ASSERT_FALSE(constant.warnings.empty());
  EXPECT_THAT(constant.warnings[0], testing::HasSubstr("velocity_knots"));
  ModelBasedOptions options = quick();
  options.velocity_knots = 5;
  const ModelBasedResult result = estimate(r, options);
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_LT(result.steady_misfit, constant.steady_misfit - 0.2);
  EXPECT_GT(correlation(result.force, r.truth.force.samples),
            correlation(constant.force, r.truth.force.samples));
  const double expected[] = {0.10049, 0.10596, 0.1, 0.09404, 0.09951};
  for (std::size_t i = 0; i < 5; ++i) {
    const double fitted =
        result.parameters.bow_velocity * (1.0 + result.parameters.velocity_knots[i]);
    EXPECT_NEAR(fitted, expected[i], 8e-4) << i;
  }
}

// The contact point 0.1 mm off in the model, and freed.
TEST(ModelBasedEstimator, FindsTheContactPoint) {
  const BowedRecord r = bowed_record(0.12, 0.02);
  ModelBasedOptions options = quick();
  options.contact = true;
  const ModelBasedResult result = estimate(r, options, 1e-4);
  EXPECT_NEAR(result.parameters.contact, 0.03, 1e-5);
}

TEST(ModelBasedEstimator, StopsWhenAsked) {
  const BowedRecord r = bowed_record(0.08, 0.02);
  EXPECT_THROW(
      ModelBasedEstimator(quick()).estimate(r.basis, r.scene.bow.position, kRecordRate,
                                            r.left.samples, r.right.samples, [] { return true; }),
      Interrupted);
}

}  // namespace
}  // namespace modcal
