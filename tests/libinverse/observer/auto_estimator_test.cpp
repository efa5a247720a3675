#include "libinverse/observer/auto_estimator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libinverse/invert.hpp"
#include "libinverse/joint/joint_estimators.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::auto_estimator_test {
namespace {

using testing::HasSubstr;

template <class Kind, class Options>
Estimate estimate(const char* name, const Options& options, const BowedRecord& r) {
  InversionOptions inversion;
  inversion.estimator = Choice<Estimator>::of<Kind>(name, options);
  const InversionRecipe recipe(inversion);
  EstimationRecord record;
  record.reactions = {r.left.samples, r.right.samples};
  return recipe.estimator()
      .prepare({r.basis, r.scene.bow.position, r.left.samples.size(), r.rate, false})
      ->estimate(record, recipe.method({.force = true, .displacement = true, .velocity = true}))
      .front();
}

Estimate automatic(const BowedRecord& r) {
  ModelBasedOptions options;
  options.laws = {"exponential"};
  options.substeps = 4;
  options.rounds = 1;
  return estimate<AutoEstimator>("auto", options, r);
}
Estimate joint(const BowedRecord& r) {
  return estimate<JointEstimator>("joint", JointEstimator::Options{}, r);
}

double error(const std::vector<double>& found, const std::vector<double>& truth) {
  const std::size_t edge = truth.size() / 10;
  return relative_rms_error(std::span(found).subspan(edge, truth.size() - 2 * edge),
                            std::span(truth).subspan(edge, truth.size() - 2 * edge));
}

TEST(AutoEstimator, FollowsALawThatExplainsTheRecord) {
  const BowedRecord r = light_record(0.15, 0.05);
  const Estimate found = automatic(r), linear = joint(r);
  EXPECT_EQ(found.side, "auto");
  EXPECT_LT(error(found.result.force, r.truth.force.samples),
            0.8 * error(linear.result.force, r.truth.force.samples));
  EXPECT_LT(error(found.result.velocity, r.truth.velocity.samples),
            error(linear.result.velocity, r.truth.velocity.samples));
  EXPECT_EQ(found.force_deviations.size(), found.result.force.size());
  ASSERT_EQ(found.notes.size(), 2u);
  EXPECT_THAT(found.notes[0], HasSubstr("friction law: exponential"));
  EXPECT_THAT(found.notes[1], HasSubstr("has a share of"));
}

// No law under a constant bow velocity explains one that swings.
TEST(AutoEstimator, FallsBackToTheJointEstimateAndSaysSo) {
  const BowedRecord r = swinging_record(0.001);
  const Estimate found = automatic(r), linear = joint(r);
  EXPECT_EQ(found.result.force, linear.result.force);
  EXPECT_EQ(found.result.velocity, linear.result.velocity);
  ASSERT_FALSE(found.notes.empty());
  EXPECT_THAT(found.notes.back(), HasSubstr("the joint estimate is taken"));
  EXPECT_THAT(found.notes.back(), HasSubstr("no friction law of the list explains the record"));
}

// Three periods are too few for the observer, which says so; the joint estimate takes them.
TEST(AutoEstimator, PassesOnWhyTheObserverRefuses) {
  const BowedRecord r = light_record(0.015, 0.02);
  const Estimate found = automatic(r);
  EXPECT_EQ(found.result.force, joint(r).result.force);
  ASSERT_FALSE(found.notes.empty());
  EXPECT_THAT(found.notes.back(), HasSubstr("the observer needs at least 4"));
}

}  // namespace
}  // namespace modcal::auto_estimator_test
