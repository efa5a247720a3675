#include "libinverse/observer/model_based_estimator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::model_based_estimator_test {
namespace {

ModelBasedResult estimate(const BowedRecord& r, const ModelBasedOptions& options,
                          double contact_error = 0.0) {
  return ModelBasedEstimator(options).estimate(r.basis, r.scene.bow.position + contact_error,
                                               r.rate, r.left.samples, r.right.samples);
}

// A short record at 2 % noise, nothing of the truth used. The limits hold two thirds of the
// distance between what was measured (velocity 0.9999, force 0.98, parameters within 2 %) and what
// a linear estimate reaches (0.84).
TEST(ModelBasedEstimator, RecoversForceAndFrictionLaw) {
  const BowedRecord r = bowed_record(0.2, 0.02);
  const ModelBasedResult result = estimate(r, quick_fit(1));
  EXPECT_GT(correlation(result.force, r.truth.force.samples), 0.95);
  EXPECT_GT(correlation(result.velocity, r.truth.velocity.samples), 0.999);
  EXPECT_LT(correlation(result.linear.force, r.truth.force.samples), 0.93);
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
      share_inside(result.force, r.truth.force.samples, result.deviation.force, shift);
  const double of_velocity =
      share_inside(result.velocity, r.truth.velocity.samples, result.deviation.velocity, 0.0);
  for (const double share : {of_force, of_velocity}) {
    EXPECT_GT(share, 0.88);
    EXPECT_LT(share, 0.99);
  }
}

TEST(ModelBasedEstimator, SaysThatTheModelIsWrong) {
  const BowedRecord r = light_record(0.06, 0.02);
  const ModelBasedResult result = estimate(r, quick_fit(1), 2e-3);
  EXPECT_GT(result.misfit, 1.3);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings[0].find("innovation misfit"), std::string::npos);
}

TEST(ModelBasedEstimator, ABowMovingBackGivesTheMirrorImage) {
  BowedRecord r = light_record(0.05, 0.02);
  const ModelBasedResult forward = estimate(r, quick_fit(1));
  for (Signal* signal : {&r.left, &r.right}) {
    for (double& value : signal->samples) value = -value;
  }
  const ModelBasedResult back = estimate(r, quick_fit(1));
  EXPECT_FALSE(forward.negated);
  EXPECT_TRUE(back.negated);
  for (std::size_t k = 0; k < forward.force.size(); ++k) {
    ASSERT_EQ(back.force[k], -forward.force[k]) << k;
    ASSERT_EQ(back.velocity[k], -forward.velocity[k]) << k;
  }
}

TEST(ModelBasedEstimator, SameBitsForAnyNumberOfThreads) {
  const BowedRecord r = light_record(0.04, 0.02);
  const ModelBasedResult several = estimate(r, quick_fit(1));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ModelBasedResult alone = estimate(r, quick_fit(1));
  EXPECT_EQ(several.force, alone.force);
  EXPECT_EQ(several.misfit, alone.misfit);
}

// The left sensor 2 % too sensitive: freed, the ratio is found.
TEST(ModelBasedEstimator, FindsTheGainOfASensor) {
  BowedRecord r = light_record(0.08, 0.01);
  for (double& value : r.left.samples) value *= 1.02;
  ModelBasedOptions options = quick_fit(1);
  options.gain = true;
  const ModelBasedResult result = estimate(r, options);
  EXPECT_NEAR(result.parameters.gain, 1.02, 0.004);
}

// Over six draws of noise the static level is off by what its deviation says. Half of its variance
// is the noise of the silent samples, half the ripple, which the observer may know: the rms of the
// ratios is 0.7 to 1, within the factor that six draws leave (χ²₆ at 0.5 and 99.5 %: 0.34 to 1.76).
TEST(ModelBasedEstimator, SaysHowFarTheStaticPartIsRecovered) {
  double sum = 0.0;
  BowedRecord r = light_record(0.06, 0.0);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    measure_again(r, 0.1, seed);
    ModelBasedOptions options = quick_fit(1);
    options.rounds = 0;
    const ModelBasedResult result = estimate(r, options);
    const double off = result.static_part.level - mean(r.truth.force.samples);
    sum += off * off / (result.static_part.deviation * result.static_part.deviation);
  }
  EXPECT_GT(std::sqrt(sum / 6.0), 0.7 * 0.34);
  EXPECT_LT(std::sqrt(sum / 6.0), 1.76);
}

// With half the modes the ripple ahead of the first wave moves the left offset by eight times the
// noise of its five silent samples: the deviation holds it, and the record is not taken for one
// that was under way.
TEST(ModelBasedEstimator, AStringOfFewModesRipplesBeforeTheFirstWave) {
  BowedRecord r = light_record(0.06, 0.0);
  measure_again(r, 0.01);
  ModelBasedOptions options = quick_fit(1);
  options.rounds = 0;
  const ModelBasedResult result = estimate(r, options);
  const double off = result.static_part.level - mean(r.truth.force.samples);
  EXPECT_LT(std::abs(off), 3.0 * result.static_part.deviation);
  const double noise = 0.01 * standard_deviation(r.left.samples) / std::sqrt(5.0);
  EXPECT_GT(result.static_part.deviation, 5.0 * noise);
  EXPECT_TRUE(result.warnings.empty());
}

// The bow's velocity swings by ±10 %, once in 0.14 s. Held constant, the estimate warns; with a
// knot at every quarter it follows as closely as lines between five knots do: the least-squares
// ones have the knots 0.098, 1.191, 0, -1.191, -0.098 times the swing.
TEST(ModelBasedEstimator, FollowsABowVelocityThatDrifts) {
  const BowedRecord r = swinging_record(0.01);
  ModelBasedOptions options = quick_fit(1);
  options.rounds = 0;
  const ModelBasedResult constant = estimate(r, options);
  ASSERT_FALSE(constant.warnings.empty());
  EXPECT_THAT(constant.warnings[0], testing::HasSubstr("velocity_knots"));
  options = quick_fit(1);
  options.velocity_knots = 5;
  const ModelBasedResult result = estimate(r, options);
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_LT(result.steady_misfit, constant.steady_misfit - 0.2);
  EXPECT_GT(correlation(result.force, r.truth.force.samples),
            correlation(constant.force, r.truth.force.samples));
  const double expected[] = {0.10098, 0.11191, 0.1, 0.08809, 0.09902};
  for (std::size_t i = 0; i < 5; ++i) {
    const double fitted =
        result.parameters.bow_velocity * (1.0 + result.parameters.velocity_knots[i]);
    EXPECT_NEAR(fitted, expected[i], 8e-4) << i;
  }
}

// The contact point 0.1 mm off in the model, and freed.
TEST(ModelBasedEstimator, FindsTheContactPoint) {
  const BowedRecord r = light_record(0.08, 0.02);
  ModelBasedOptions options = quick_fit(1);
  options.contact = true;
  const ModelBasedResult result = estimate(r, options, 1e-4);
  EXPECT_NEAR(result.parameters.contact, 0.03, 1e-5);
}

// The left sensor 4.9 µs late, an eighth of a sample: every eighth sample of a finer simulation,
// one step back. Were nothing else unknown, noise s would leave the delay s/√Σ(dR₁/dt)²; the other
// parameters hardly look like a delay: within four of these, 4 % of the delay.
TEST(ModelBasedEstimator, FindsTheDelayOfASensor) {
  constexpr std::size_t kFiner = 8;
  BowedRecord r = light_record(0.12, 0.0);
  const Simulation fine = ModalEvent({}).simulate(r.scene, kFiner * r.rate, OutputRequest::all());
  std::vector<double>& left = r.truth.left_reaction.samples;
  for (std::size_t k = 1; k < left.size(); ++k) {
    left[k] = fine.left_reaction.samples[kFiner * k - 1];
  }
  measure_again(r, 0.02);
  ModelBasedOptions options = quick_fit(1);
  options.delay = true;
  const ModelBasedResult result = estimate(r, options);
  double information = 0.0;
  for (std::size_t k = 1; k + 1 < left.size(); ++k) {
    const double slope = 0.5 * r.rate * (left[k + 1] - left[k - 1]);
    information += slope * slope;
  }
  const double deviation = 0.02 * standard_deviation(left) / std::sqrt(information);
  const double delay = 1.0 / (static_cast<double>(kFiner) * r.rate);
  EXPECT_NEAR(result.parameters.delay, delay, 4.0 * deviation);
  EXPECT_LT(deviation, 0.012 * delay);
  EXPECT_LT(result.steady_misfit, result.expected_misfit + 4.0 * result.misfit_deviation);
}

// Every modal frequency of a string of 12 modes 2e-4 off, up and down in turn. The bow renews a
// mode's phase each period of 2π/ω₁: its share of the noise, 0.01 √(2/130 samples) n/1.1 for
// reactions whose partials fall as 1.1/n, is a frequency error of that over 2πn, averaged over 23
// periods 3.7e-5; what else is unknown adds to it: over draws of noise the rms over the modes is
// 3.5e-5 to 6e-5. Mode 11 has a node at the bow.
TEST(ModelBasedEstimator, FindsTheModalFrequencies) {
  Scene scene = bowed_scene(0.12);
  scene.string.modes = 12;
  BowedRecord r = record_of(scene, 0.25 * kRecordRate, 0.01);
  const auto off = [](std::size_t n) { return n % 2 == 0 ? -2e-4 : 2e-4; };
  for (std::size_t n = 0; n < r.basis.size(); ++n) r.basis.omega[n] /= 1.0 + off(n);
  ModelBasedOptions options = quick_fit(1);
  options.frequencies = true;
  const ModelBasedResult result = estimate(r, options);
  ASSERT_EQ(result.parameters.detuning.size(), 12u);
  double sum = 0.0;
  for (std::size_t n = 0; n < 12; ++n) {
    const double found = result.parameters.detuning[n];
    if (n == 10) {
      EXPECT_EQ(found, 0.0);
    } else {
      sum += (found - off(n)) * (found - off(n));
    }
  }
  EXPECT_LT(std::sqrt(sum / 11.0), 1e-4);
}

// The normal force rises from 0.9 N to 1.1 N, and with it the force drop of 0.2 N per newton.
// Between knots ln F_N is a line and bends by 0.1²/8 = 1.25e-3 at most; over draws of noise the
// knots scatter by 1e-3: four of these and the bend.
TEST(ModelBasedEstimator, FollowsANormalForceThatDrifts) {
  Scene scene = light_scene(0.12);
  RampGesture::Options ramp;
  ramp.from = 0.9;
  ramp.to = 1.1;
  ramp.duration = scene.duration;
  scene.bow.force_gesture = Choice<Gesture>::of<RampGesture>("ramp", ramp);
  const BowedRecord r = record_of(scene, kLightRate, 0.02);
  ModelBasedOptions options = quick_fit(1);
  options.force_knots = 3;
  const ModelBasedResult result = estimate(r, options);
  EXPECT_TRUE(result.warnings.empty());
  const double expected[] = {0.9, 1.0, 1.1};
  for (std::size_t i = 0; i < 3; ++i) {
    const double normal =
        result.parameters.sliding.force_drop / 0.2 * std::exp(result.parameters.force_knots[i]);
    EXPECT_NEAR(normal, expected[i], 5.3e-3) << i;
  }
}

TEST(ModelBasedEstimator, StopsWhenAsked) {
  const BowedRecord r = light_record(0.08, 0.02);
  const std::atomic<bool> asked = true;
  EXPECT_THROW(ModelBasedEstimator(quick_fit(1))
                   .estimate(r.basis, r.scene.bow.position, r.rate, r.left.samples, r.right.samples,
                             StopToken(asked)),
               Interrupted);
}

}  // namespace
}  // namespace modcal::model_based_estimator_test
