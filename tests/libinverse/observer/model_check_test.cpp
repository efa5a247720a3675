#include "libinverse/observer/model_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::observer::model_check_test {
namespace {

using testing::HasSubstr;

// A saw: what a force that sticks and slides looks like.
std::vector<double> saw(double ringing_amplitude) {
  std::vector<double> force(8192);
  for (std::size_t j = 0; j < force.size(); ++j) {
    const auto k = static_cast<double>(j);
    force[j] = std::fmod(k / 173.3, 1.0) + ringing_amplitude * std::cos(0.96 * M_PI * k);
  }
  return force;
}

TEST(Ringing, IsSeenAndRefusedWithARemedy) {
  EXPECT_LT(ringing(saw(0.0)), 1.5);
  EXPECT_NO_THROW(require_no_ringing(saw(0.0), 51200.0));
  EXPECT_GT(ringing(saw(0.1)), kMostRinging);
  try {
    require_no_ringing(saw(0.1), 51200.0);
    FAIL() << "accepted";
  } catch (const InvalidInput& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("rings between 23040 and 25600 Hz"));
    EXPECT_THAT(refusal.what(), HasSubstr("estimator: joint"));
  }
}

// The light record's contact has 1e5 N/m. At a hundred thousand times that it is rigid, and nothing
// in the innovations holds it.
TEST(Stiffness, OfARigidContactIsRefused) {
  const BowedRecord r = light_record(0.04, 0.02);
  const ObservedRecord record =
      observe_record(r.basis, r.scene.bow.position, r.rate, r.left.samples, r.right.samples);
  const ObserverRuns runs(record, {0.01}, {});
  ObserverParameters p;
  p.sliding.dynamic_force = p.sliding.force_drop = 0.2;
  p.sliding.decay = 5.0;
  p.bow_velocity = 0.1;
  p.contact = record.contact;
  p.stiffness = 1e5;
  EXPECT_NO_THROW(require_finite_stiffness(runs, p, {0}));
  p.stiffness = 1e10;
  ASSERT_GT(p.stiffness, rigid_stiffness(runs));
  try {
    require_finite_stiffness(runs, p, {0});
    FAIL() << "accepted";
  } catch (const InvalidInput& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("runs away: at 1e+10 N/m"));
    EXPECT_THAT(refusal.what(), HasSubstr("take fewer modes"));
  }
  // Two deviations of one parameter are a factor e² of the likelihood: what tells it from four
  // times as much by a little more is held, by a little less is not.
  for (const double share : {1.15, 2.0}) {
    p.stiffness = share * rigid_stiffness(runs);
    ObserverParameters stiffer = p;
    stiffer.stiffness *= 4.0;
    const double here = misfit(runs.innovations(p, {0}, record.samples()));
    const double there = misfit(runs.innovations(stiffer, {0}, record.samples()));
    // Of two numbers a sample with the misfit at its least, ln L is −N ln J.
    const double told = static_cast<double>(record.samples()) * std::log(there / here);
    if (share < 2.0) {
      EXPECT_GT(told, 2.1);
      EXPECT_LT(told, 3.0);
      EXPECT_NO_THROW(require_finite_stiffness(runs, p, {0}));
    } else {
      EXPECT_LT(told, 1.9);
      EXPECT_GT(told, 1.0);
      EXPECT_THROW(require_finite_stiffness(runs, p, {0}), InvalidInput);
    }
  }
}

TEST(Offset, BesideTheLevelBeforeTheFirstWaveIsWarnedOfWithARemedy) {
  const BowedRecord r = light_record(0.04, 0.02);
  const ObservedRecord record =
      observe_record(r.basis, r.scene.bow.position, r.rate, r.left.samples, r.right.samples);
  ModelBasedResult result;
  result.parameters.offset[0] = 1.0;
  add_warnings({.misfit_limit = 2.0}, record, std::vector<double>{1e-6, 1e-6}, result);
  EXPECT_THAT(result.warnings,
              testing::Contains(testing::AllOf(HasSubstr("offset of the reaction at x = 0"),
                                               HasSubstr("compare with the joint estimate"))));
}

TEST(ModelBasedOptions, AllLawsAreFittedUnlessStated) {
  const auto names = friction_law_names();
  EXPECT_EQ(ModelBasedOptions{}.laws, (std::vector<std::string>(names.begin(), names.end())));
}

TEST(ModelBasedEstimator, MayBeToldTheNoise) {
  const BowedRecord r = light_record(0.04, 0.02);
  ModelBasedOptions options = quick_fit(0);
  options.noise_rms[0] = 1.5e-3;
  options.noise_rms[1] = 2.5e-3;
  const ModelBasedResult result = ModelBasedEstimator(options).estimate(
      r.basis, r.scene.bow.position, r.rate, r.left.samples, r.right.samples);
  EXPECT_EQ(result.noise[0], 1.5e-3);
  EXPECT_EQ(result.noise[1], 2.5e-3);
}

// Share of the truth in the 95 % band behind the first quarter.
double held(const std::vector<double>& x, const std::vector<double>& truth,
            const std::vector<double>& deviation) {
  const double shift = mean(x) - mean(truth);
  std::size_t inside = 0;
  for (std::size_t k = x.size() / 4; k < x.size(); ++k) {
    inside += std::abs(x[k] - shift - truth[k]) <= 1.96 * deviation[k] ? 1 : 0;
  }
  return static_cast<double>(inside) / (0.75 * static_cast<double>(x.size()));
}

// The bow's velocity swings by 10 %, which a constant one does not explain.
TEST(ModelBasedEstimator, BarsHoldTheErrorOfAWrongModel) {
  const BowedRecord r = swinging_record(0.01);
  const ModelBasedResult result =
      ModelBasedEstimator(quick_fit(0))
          .estimate(r.basis, r.scene.bow.position, r.rate, r.left.samples, r.right.samples);
  EXPECT_FALSE(result.explained());
  EXPECT_GT(result.model_error.force_square, 0.0);
  EXPECT_GT(held(result.force, r.truth.force.samples, result.deviation.force), 0.85);
  EXPECT_GT(held(result.velocity, r.truth.velocity.samples, result.deviation.velocity), 0.85);
}

// Whatever law is fitted, R₁ drifts and R₂ does not.
TEST(ModelBasedEstimator, BarsHoldTheErrorOfASensor) {
  BowedRecord r = light_record(0.15, 0.01);
  const double size = standard_deviation(r.left.samples);
  for (std::size_t k = 0; k < r.left.size(); ++k) {
    r.left.samples[k] += size * static_cast<double>(k) / static_cast<double>(r.left.size());
  }
  const ModelBasedResult result = ModelBasedEstimator(quick_fit(0))
                                      .estimate(r.basis, r.scene.bow.position, r.rate,
                                                r.left.samples, r.right.samples, {}, true);
  EXPECT_GT(held(result.force, r.truth.force.samples, result.deviation.force), 0.95);
}

}  // namespace
}  // namespace modcal::observer::model_check_test
