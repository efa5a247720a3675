#include "libcalib/identifiability/neighbor_test.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/identifiability/neighbor_kernel.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::neighbor_test_test {
namespace {

constexpr std::size_t kMode = 8;  // f_9

QuadraticPrior wide_prior(const StringUnknowns& unknowns) {
  const Eigen::VectorXd wide = Eigen::VectorXd::Constant(50, kWidePrior);
  return unknowns.prior(unknowns.start(), {wide, 0.0});
}

TEST(Neighbors, AreNoneAtTheTruth) {
  const BowedCase bowed = bowed_case(0.0285, 0.0, 0.5);
  const double highest = likelihood_band(bowed.truth, NAN, 51200.0);
  const StringUnknowns unknowns = StringUnknowns::frequencies(bowed.truth, {});
  for (const double sigma : {0.0, 10.0}) {
    const ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.02, 4), sigma, highest));
    const std::vector<Neighbor> found =
        neighbors(likelihood, unknowns, wide_prior(unknowns), unknowns.start());
    Eigen::VectorXd theta = unknowns.start();
    EXPECT_EQ(leave_false_minima(found, theta), 0u) << sigma;
    EXPECT_TRUE(theta.isZero());
  }
}

TEST(Neighbors, BringAModeBackToWhereItIs) {
  const BowedCase bowed = bowed_case(0.0285, 0.0, 0.5);
  const double highest = likelihood_band(bowed.truth, NAN, 51200.0);
  const StringUnknowns unknowns = StringUnknowns::frequencies(bowed.truth, {});
  for (const double sigma : {0.0, 10.0}) {
    const ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.02, 4), sigma, highest));
    Eigen::VectorXd theta = unknowns.start();
    theta[kMode] += 5e-3;
    const std::vector<Neighbor> found =
        neighbors(likelihood, unknowns, wide_prior(unknowns), theta);
    EXPECT_EQ(leave_false_minima(found, theta), 1u) << sigma;
    // Half a width of its damped resonance: σ/ω_9 = 1e-3, and 1e-3 of its own damping.
    EXPECT_NEAR(theta[kMode], 0.0, sigma == 0.0 ? 5e-4 : 1e-3);
  }
}

// Brute force: the same move in the whole likelihood, where every end state is found anew. That
// lowers the cost of both places a little; the move itself is hundreds.
TEST(Neighbors, GainWhatTheWholeLikelihoodGains) {
  BowedCase bowed = bowed_case(0.0285, 0.0, 0.5);
  bowed.truth.sensors = {.gain = 1.05, .delay = 2e-6, .corner = 5.0, .free = false};
  for (double& sample : bowed.clean[1]) sample *= 1.05;
  const double highest = likelihood_band(bowed.truth, NAN, 51200.0);
  const StringUnknowns unknowns = StringUnknowns::frequencies(bowed.truth, {});
  for (const double sigma : {0.0, 10.0}) {
    const ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.02, 4), sigma, highest));
    Eigen::VectorXd there = unknowns.start(), here = there;
    here[kMode] += 5e-3;
    const QuadraticPrior prior = wide_prior(unknowns);
    const Neighbor found = neighbors(likelihood, unknowns, prior, here)[kMode];
    there[kMode] = here[kMode] + found.shift;
    const double gain = likelihood.cost(unknowns.model(here)) + prior.value(here) -
                        likelihood.cost(unknowns.model(there)) - prior.value(there);
    EXPECT_GT(gain, 100.0);
    EXPECT_NEAR(found.gain / gain, 1.0, 0.1) << sigma;
  }
}

TEST(Neighbors, LeaveAHeldFrequencyAlone) {
  const BowedCase bowed = bowed_case(0.0285, 0.0, 0.25);
  const double highest = likelihood_band(bowed.truth, NAN, 51200.0);
  ModelPoint wrong = bowed.truth;
  wrong.basis.omega[kMode] *= 1.005;
  const UnknownsOptions options{.fixed = {{.parameter = "f_9"}}};
  const StringUnknowns unknowns =
      StringUnknowns::frequencies(wrong, options, StatedPriors(options, wrong));
  const ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.02, 4), 0.0, highest));
  const std::vector<Neighbor> found =
      neighbors(likelihood, unknowns, wide_prior(unknowns), unknowns.start());
  EXPECT_EQ(found[kMode].shift, 0.0);
}

TEST(Rivals, TakeTheSightOfAMode) {
  const Eigen::VectorXd seen = Eigen::VectorXd::Constant(2, 1e-4);
  ModeSight sight{.delta = Eigen::VectorXd::Zero(2), .seen = seen, .error = seen};
  doubt_rivals({{.shift = 3e-3, .gain = -4.0}, {.shift = 3e-3, .gain = -5.0}}, sight);
  EXPECT_EQ(sight.seen[0], kWidePrior);
  EXPECT_EQ(sight.error[0], 3e-3);
  EXPECT_EQ(sight.seen[1], 1e-4);
}

}  // namespace
}  // namespace modcal::neighbor_test_test
