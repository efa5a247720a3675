#include "libcalib/identifiability/law_followers.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/random.hpp"

namespace modcal::law_followers_test {
namespace {

constexpr Eigen::Index kModes = 50;

// A law of its own, errors of `seen` and scatter of `width` about it.
ModeSight drawn(double width, std::uint64_t seed) {
  std::vector<double> error(kModes), scatter(kModes);
  fill_standard_normal(StreamKey(seed).with("error"), error);
  fill_standard_normal(StreamKey(seed).with("scatter"), scatter);
  ModeSight sight{.delta = Eigen::VectorXd(kModes), .seen = Eigen::VectorXd(kModes), .error = {}};
  for (Eigen::Index i = 0; i < kModes; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const double number = static_cast<double>(i + 1);
    sight.seen[i] = 2e-5 * (1.0 + number);  // 4e-5 to 1e-3
    sight.delta[i] = 1e-3 + 1e-7 * number * number + sight.seen[i] * error[n] + width * scatter[n];
  }
  sight.error = sight.seen;
  return sight;
}

TEST(LawFollowers, StayWhereNoModeLeaves) {
  // One string in 370 loses a mode: of 200, five or more have probability 3e-4. Doubtful is one
  // mode of 370, or 27 of 10000, and √27 = 5 its scatter.
  for (const double width : {0.0, 3e-4}) {
    std::size_t leaving = 0, doubtful = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      const LawFollowers found = find_followers(drawn(width, seed), 0.0);
      leaving += found.leaving();
      for (const LawTie tie : found.ties) doubtful += tie == LawTie::kDoubtful ? 1 : 0;
    }
    EXPECT_LE(leaving, 4u) << width;
    EXPECT_GT(doubtful, 5u) << width;
    EXPECT_LT(doubtful, 60u) << width;
  }
}

TEST(LawFollowers, LoseTheModesThatLeaveAndKeepTheirOwnWidth) {
  double sum = 0.0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    ModeSight sight = drawn(3e-4, seed);
    // Four of them on one side, well seen: least squares alone would follow them.
    for (const Eigen::Index i : {2, 7, 8, 11}) sight.delta[i] += 6e-3;
    const LawFollowers found = find_followers(sight, 0.0);
    EXPECT_EQ(found.leaving(), 4u) << seed;
    for (const Eigen::Index i : {2, 7, 8, 11}) {
      EXPECT_EQ(found.ties[static_cast<std::size_t>(i)], LawTie::kLeaves);
      // The scatter and the law's own error, 3e-4/√20; five of them.
      EXPECT_NEAR(found.rest[i], 6e-3, 5.0 * 3.2e-4);
    }
    sum += found.width;
  }
  // Σ(τ²/(s² + τ²))² over the modes seen to 5e-4 is 7.5: one τ scatters by ½√(2/7.5) = 0.26, the
  // mean of 50 by 0.04; the root's own bias is −0.26²/2. Four times the one and the other.
  EXPECT_NEAR(sum / 50.0, 3e-4, 0.2 * 3e-4);
}

// An end on a mode of the body at `at` f_0 moves every f_n by c/(f_b² − n²) in units of
// f_0. The two modes beside it show it; the others, which the data tell less of, may be off by no
// more than is said of them.
TEST(LawFollowers, AreAsWideAsWhatMovedTheirNeighbors) {
  for (const double at : {2.2, 2.5, 2.8, 9.4, 9.5, 9.6}) {
    ModeSight sight = drawn(0.0, 7);
    const auto shift = [at](Eigen::Index i) {
      const double n = static_cast<double>(i + 1);
      return 1e-3 * at / (at * at - n * n);
    };
    sight.seen.setConstant(2e-4);
    const auto below = static_cast<Eigen::Index>(at) - 1;
    for (const Eigen::Index i : {below, below + 1}) sight.seen[i] = 2e-5;
    for (Eigen::Index i = 0; i < kModes; ++i) sight.delta[i] = 1e-3 + shift(i);
    sight.error = sight.seen;
    const LawFollowers found = find_followers(sight, 0.0);
    for (const Eigen::Index i : {below, below + 1}) {
      EXPECT_EQ(found.ties[static_cast<std::size_t>(i)], LawTie::kLeaves) << at;
    }
    const Eigen::VectorXd most = found.disturbances();
    for (Eigen::Index i = 0; i < kModes; ++i) {
      if (found.ties[static_cast<std::size_t>(i)] == LawTie::kLeaves) {
        EXPECT_EQ(most[i], 0.0);
        continue;
      }
      EXPECT_LE(std::abs(shift(i)), 1.05 * most[i] + 1e-5) << at << " " << i + 1;
      EXPECT_GE(found.scatters()[i], most[i]);
    }
    EXPECT_EQ(LawFollowers::all(kModes, 1e-4).disturbances().norm(), 0.0);
  }
}

TEST(LawFollowers, AreToldByTheWidthThatIsKnown) {
  ModeSight sight = drawn(0.0, 3);
  sight.delta[4] += 3e-3;  // twenty of its errors
  const LawFollowers found = find_followers(sight, 0.0, 2e-3);
  EXPECT_EQ(found.leaving(), 0u);
  EXPECT_EQ(found.prior_width, 2e-3);
  EXPECT_LT(found.width, 1e-4);  // estimated without the mode
  EXPECT_EQ(find_followers(sight, 0.0).ties[4], LawTie::kLeaves);
  EXPECT_EQ(find_followers(sight, 0.0, 1e-5).ties[4], LawTie::kLeaves);
}

TEST(LawFollowers, AreNotTestedByTooFew) {
  ModeSight sight = drawn(0.0, 5);
  sight.delta[1] += 5e-3;
  for (Eigen::Index i = 6; i < kModes; ++i) sight.seen[i] = sight.error[i] = kWidePrior;
  EXPECT_EQ(find_followers(sight, 0.0).leaving(), 0u);
  for (Eigen::Index i = 3; i < 6; ++i) sight.seen[i] = kWidePrior;
  EXPECT_EQ(find_followers(sight, 0.0).width, kWidePrior);
}

TEST(LawFollowers, TakeAFrequencyThatIsKnownExactly) {
  ModeSight sight = drawn(0.0, 9);
  sight.seen[3] = sight.error[3] = 0.0;
  const LawFollowers found = find_followers(sight, 0.0);
  EXPECT_TRUE(std::isfinite(found.width));
  EXPECT_TRUE(found.rest.allFinite());
}

TEST(LawFollowers, HaveNoScatterWhereEveryFrequencyIsKnownAndOnTheLaw) {
  ModeSight sight = drawn(0.0, 11);
  sight.delta.setZero();
  sight.seen.setZero();
  sight.error.setZero();
  const LawFollowers found = find_followers(sight, 0.0);
  EXPECT_EQ(found.scatter, 0.0);
  EXPECT_TRUE(found.scatters().allFinite());
}

}  // namespace
}  // namespace modcal::law_followers_test
