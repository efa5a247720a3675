#include "libcalib/identifiability/mode_verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/identifiability/joint_report.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::mode_verdict_test {
namespace {

struct Found {
  ModelPoint model;
  Eigen::VectorXd deviation, seen;
  LawFollowers followers;

  Found() : model{make_modal_basis(paper_scene().string), 0.0285} {
    const auto modes = static_cast<Eigen::Index>(model.basis.size());
    deviation = Eigen::VectorXd::Constant(modes, 2e-5);
    seen = Eigen::VectorXd::Constant(modes, 1e-4);
    followers = LawFollowers::all(modes, 1e-5);
  }
  std::vector<ModeVerdict> verdicts() const {
    return free_verdicts(model, deviation, seen, followers);
  }
};

TEST(FreeVerdicts, IdentifyWhatTheDataSee) {
  Found found;
  found.seen[3] = 1.5e-3;
  const std::vector<ModeVerdict> verdicts = found.verdicts();
  EXPECT_EQ(verdicts[0].source, ModeSource::kIdentified);
  EXPECT_EQ(verdicts[0].deviation, 2e-5);
  EXPECT_EQ(verdicts[0].data_deviation, 1e-4);
  EXPECT_EQ(verdicts[3].source, ModeSource::kLaw);
  EXPECT_EQ(verdicts[3].deviation, 2e-5);
}

TEST(FreeVerdicts, DoubtWhereDataAndLawDisagree) {
  Found found;
  for (const std::size_t n : {2u, 5u}) {
    found.followers.ties[n] = LawTie::kDoubtful;
    found.followers.rest[static_cast<Eigen::Index>(n)] = -3e-4;
  }
  found.seen[5] = 1.5e-3;
  const std::vector<ModeVerdict> verdicts = found.verdicts();
  EXPECT_EQ(verdicts[2].source, ModeSource::kIdentified);
  EXPECT_EQ(verdicts[5].source, ModeSource::kPrior);
  for (const std::size_t n : {2u, 5u}) {
    EXPECT_EQ(verdicts[n].reason, WeakReason::kDoubt);
    EXPECT_DOUBLE_EQ(verdicts[n].deviation, std::hypot(2e-5, 3e-4));
  }
}

TEST(FreeVerdicts, KnowAModeThatLeavesTheLawByTheDataAlone) {
  Found found;
  for (const std::size_t n : {1u, 4u}) found.followers.ties[n] = LawTie::kLeaves;
  found.seen[4] = 1.5e-3;
  const std::vector<ModeVerdict> verdicts = found.verdicts();
  EXPECT_EQ(verdicts[1].source, ModeSource::kIdentified);
  EXPECT_EQ(verdicts[1].deviation, 2e-5);
  // Neither law nor data have it.
  EXPECT_EQ(verdicts[4].source, ModeSource::kPrior);
  EXPECT_EQ(verdicts[4].deviation, kDeparted);
  EXPECT_EQ(not_following(verdicts), (std::vector<std::size_t>{1, 4}));
}

// Informations of 65 times N̄, as noise and a model that is off by 1e-5 have left in nodes.
TEST(SightOf, HasNoModeInANodeLeaveTheLawUnproven) {
  constexpr Eigen::Index kModes = 4;
  const Eigen::VectorXd delta = Eigen::VectorXd::Constant(kModes, 2.4e-3);
  const Eigen::VectorXd deviation = Eigen::VectorXd::Constant(kModes, 1.8e-4);
  const Eigen::MatrixXd noise = 1e5 * Eigen::MatrixXd::Identity(kModes, kModes);
  Eigen::MatrixXd information = 65.0 * noise;
  information(2, 2) = 200.0 * noise(2, 2);
  ModeSight sight = sight_of(delta, deviation, information, noise, {false, true, true, true});
  EXPECT_EQ(sight.seen, deviation);
  EXPECT_EQ(sight.error[1], 3.6e-4);
  LawFollowers followers = LawFollowers::all(kModes, 1e-5);
  followers.ties = {LawTie::kLeaves, LawTie::kLeaves, LawTie::kLeaves, LawTie::kFollows};
  deny_surprises(followers, sight);
  EXPECT_EQ(followers.ties, (std::vector<LawTie>{LawTie::kLeaves, LawTie::kFollows, LawTie::kLeaves,
                                                 LawTie::kFollows}));
  EXPECT_EQ(sight.seen[0], 1.8e-4);
  EXPECT_EQ(sight.seen[1], kWidePrior);
  EXPECT_EQ(sight.seen[2], 1.8e-4);  // proven
  EXPECT_EQ(sight.seen[3], 1.8e-4);  // follows
}

TEST(Release, OpensThePriorOfAModeThatLeaves) {
  Found found;
  found.followers.ties[1] = LawTie::kLeaves;
  found.followers.ties[2] = LawTie::kDoubtful;
  ModeSight sight{.delta = found.deviation, .seen = found.seen, .error = found.seen};
  sight.seen[1] = kWidePrior;  // unproven, until it left
  sight.error[1] = 2e-4;
  Eigen::VectorXd widths = prior_widths(sight.seen, 2e-3, 1e-5);
  EXPECT_EQ(widths[1], 1e-5);
  release(found.followers, sight, widths);
  EXPECT_EQ(widths[1], kDeparted);
  EXPECT_EQ(sight.seen[1], 2e-4);
  EXPECT_EQ(widths[0], 2e-3);

  widths = prior_widths(sight.seen, 1e-5, 1e-5);
  release(found.followers, sight, widths);
  EXPECT_EQ(widths[2], kWidePrior);
  EXPECT_EQ(widths[0], 1e-5);
}

TEST(Departures, AreThoseFromTheLaw) {
  Found found;
  ContinuationResult result;
  result.modes = found.verdicts();
  result.found_law = {.fundamental = 196.0, .inharmonicity = 0.0};
  result.modes[9].frequency *= 1.004;
  result.modes[9].tie = LawTie::kLeaves;
  const double alone = result.modes[9].deviation;
  report_departures({}, result);
  // The basis has f_n = n·196 Hz to rounding.
  EXPECT_NEAR(result.modes[9].departure, 4e-3, 1e-12);
  EXPECT_NEAR(result.modes[8].departure, 0.0, 1e-12);
  EXPECT_EQ(result.modes[9].deviation, alone);
  // Of a bridge that moves by one chance in eight, √(1 − 2/8) of the departure.
  const std::vector<ScoreTest> tests = {{.cause = "drift of the tuning", .log_p = -30.0},
                                        {.cause = "bridge that moves", .log_p = std::log(0.125)}};
  const double follows = result.modes[8].deviation;
  report_departures(tests, result);
  EXPECT_NEAR(result.modes[9].deviation, std::hypot(alone, std::sqrt(0.75) * 4e-3), 1e-12);
  EXPECT_EQ(result.modes[8].deviation, follows);
}

// Modes 46 and above of f0 = 196 Hz lie above 9 kHz.
// Modes that follow a law lie on the law that is found with them; one that leaves it need not.
TEST(Contradiction, IsAModeThatFollowsTheLawAndLiesOffIt) {
  const Found found;
  ContinuationResult result;
  result.found_law = {.fundamental = 196.0, .inharmonicity = 0.0};
  result.frequencies_free = true;
  result.modes = found.verdicts();
  result.law_width = 1e-5;
  EXPECT_FALSE(result.contradicts_itself());
  EXPECT_LT(result.farthest_follower(), 1.0);
  // By ten times √(2² + 1²)·10⁻⁵.
  result.modes[20].frequency *= 1.0 + 22.4e-5;
  EXPECT_NEAR(result.farthest_follower(), 10.0, 0.1);
  EXPECT_TRUE(result.contradicts_itself());
  result.modes[20].tie = LawTie::kLeaves;
  EXPECT_FALSE(result.contradicts_itself());
}

TEST(ModesOutOfBand, AreNotSeenWhereOthersStandAboveThem) {
  Found found;
  ModeSight sight{.seen = found.seen, .error = found.seen};
  const double highest = 2.0 * M_PI * 9000.0;
  leave_out_of_band(found.model, highest, sight);
  EXPECT_EQ(sight.seen, found.seen);
  found.model.higher = HigherModeLaw::above(found.model.basis, 196.0, 0.0, 9000.0);
  leave_out_of_band(found.model, highest, sight);
  for (Eigen::Index n = 0; n < sight.seen.size(); ++n) {
    const double left = n + 1 < 46 ? 1e-4 : kWidePrior;
    EXPECT_EQ(sight.seen[n], left) << n;
    EXPECT_EQ(sight.error[n], left) << n;
  }
}

// Two strokes of which mode n is told to n 1e-4: the mean has a deviation of √2 1e-4/√Σ 1/n².
ContinuationResult stroke_of(double shift) {
  ContinuationResult fit;
  for (int n = 1; n <= 3; ++n) {
    fit.modes.push_back({.frequency = n * 196.0 * std::exp(shift),
                         .data_deviation = 1e-4 * n,
                         .source = ModeSource::kIdentified});
  }
  return fit;
}

TEST(TunedApart, TellsStrokesOfAnotherTuning) {
  const double deviation = std::sqrt(2.0) * 1e-4 / std::sqrt(1.0 + 1.0 / 4.0 + 1.0 / 9.0);
  const double far = 3.5 * deviation;
  const auto apart = tuned_apart({stroke_of(0.0), stroke_of(-2.9 * deviation), stroke_of(far)});
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->stroke, 2u);
  EXPECT_NEAR(apart->relative, far, 1e-12);
  EXPECT_NEAR(apart->deviation, deviation, 1e-12);
}

TEST(TunedApart, LeavesWhatChanceMakesAndModesThatOneDoesNotTell) {
  EXPECT_FALSE(tuned_apart({stroke_of(0.0), stroke_of(2e-4)}));
  EXPECT_FALSE(tuned_apart({stroke_of(0.0)}));
  ContinuationResult other = stroke_of(1e-2);
  for (ModeVerdict& mode : other.modes) mode.source = ModeSource::kLaw;
  EXPECT_FALSE(tuned_apart({stroke_of(0.0), other}));
}

}  // namespace
}  // namespace modcal::mode_verdict_test
