#include "libcalib/optimizers/staged/continuation_attempt.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::continuation_attempt_test {
namespace {

constexpr double kBand = 2.0 * std::numbers::pi * 10300.0;

// √k bins of a level: 1.4 % of its power from 10 000, four of them in its root.
TEST(TakenNoise, OfARightModelMayBeMoreAndLessThanWasRead) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  NoisyRecords records = noisy(bowed, 0.01, 1);
  const std::array<double, 2> truth = records.deviation;
  records.deviation = {truth[0] / 1.5, truth[1] * 1.5};
  const ContinuationOptions options;
  const StatedPriors priors;
  std::optional<LawEstimate> law;
  const AttemptInput input{.initial = bowed.truth,
                           .records = records,
                           .options = options,
                           .priors = priors,
                           .highest = kBand,
                           .first_law = law};
  const auto again = [&] {
    return input.take_noise(ProjectedLikelihood(WhitenedRecord::of(records, 0.0, kBand)),
                            bowed.truth, 0.1);
  };
  EXPECT_TRUE(again());
  EXPECT_NEAR(records.deviation[0] / truth[0], 1.0, 0.03);
  EXPECT_NEAR(records.deviation[1] / truth[1], 1.0, 0.03);
  // What was taken differs no more.
  EXPECT_FALSE(again());
}

TEST(TakenNoise, ThatIsStatedStays) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 0.2);
  NoisyRecords records = noisy(bowed, 0.01, 1);
  records.deviation[0] *= 1.5;
  const std::array<double, 2> stated = records.deviation;
  const ContinuationOptions options{.left_noise = stated[0]};
  const StatedPriors priors;
  std::optional<LawEstimate> law;
  const AttemptInput input{.initial = bowed.truth,
                           .records = records,
                           .options = options,
                           .priors = priors,
                           .highest = kBand,
                           .first_law = law};
  EXPECT_FALSE(input.take_noise(ProjectedLikelihood(WhitenedRecord::of(records, 0.0, kBand)),
                                bowed.truth, 0.1));
  EXPECT_EQ(records.deviation, stated);
}

}  // namespace
}  // namespace modcal::continuation_attempt_test
