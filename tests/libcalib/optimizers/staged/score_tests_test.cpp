#include "libcalib/optimizers/staged/score_tests.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::score_tests_test {
namespace {

constexpr double kBand = 2.0 * std::numbers::pi * 10300.0;

// Unknowns that take a good part of what a cause adds.
UnknownsOptions all_free() {
  UnknownsOptions options;
  options.damping = "each";
  for (std::size_t i = 0; i < Sensor::kCount; ++i) options.sensor[i].free = true;
  return options;
}

struct Case {
  BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.1);
  StringUnknowns unknowns = StringUnknowns::frequencies(bowed.truth, all_free());
  Eigen::VectorXd theta = unknowns.theta_of(bowed.truth);

  WhitenedRecord record(std::uint64_t seed) const {
    return WhitenedRecord::of(noisy(bowed, 0.02, seed), 0.0, kBand);
  }
  std::map<std::string, ScoreTest> tests(const WhitenedRecord& record) const {
    NewtonOptions options;
    options.prior = 1e-6 * Eigen::MatrixXd::Identity(theta.size(), theta.size());
    options.prior_mean = theta;
    std::map<std::string, ScoreTest> found;
    for (ScoreTest& test : score_tests(ProjectedLikelihood(record), unknowns, theta, options,
                                       Eigen::VectorXd::Ones(theta.size()), 1.0)) {
      found.emplace(test.cause, test);
    }
    return found;
  }
};

// Of causes that are not there S is χ² of the degrees, at the truth as at a fit: its mean over 60
// records is within 4 √(2 d/60) of d.
TEST(ScoreTests, OfWhatIsNotThereAreChiSquares) {
  const Case the;
  std::map<std::string, double> mean;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    for (const auto& [name, test] : the.tests(the.record(seed))) mean[name] += test.statistic / 60;
  }
  // Those of which one alone is tried.
  const std::pair<std::string_view, double> degrees[] = {
      {kDrift, 1.0}, {kNonlinear, 2.0}, {kContact, 2.0}, {kModesAbove, 4.0}};
  for (const auto& [name, d] : degrees) {
    EXPECT_NEAR(mean.at(std::string(name)), d, 4.0 * std::sqrt(2.0 * d / 60.0)) << name;
  }
}

// A second polarization is as likely lower as higher.
TEST(MisfitCauses, TryEveryDetuningBothWays) {
  const Case the;
  std::set<std::string> details;
  for (const MisfitCause& cause :
       misfit_causes(ProjectedLikelihood(the.record(1)), the.bowed.truth)) {
    if (cause.name == kPolarization) details.insert(cause.detail);
  }
  EXPECT_EQ(details.size(), 6u);
  for (std::string detail : details) {
    char& sign = detail.at(detail.find_first_of("+-"));
    sign = sign == '+' ? '-' : '+';
    EXPECT_TRUE(details.contains(detail)) << detail;
  }
}

// One amplitude comes back with its sign.
TEST(ScoreTests, TellADriftBothWays) {
  const Case the;
  const WhitenedRecord plain = the.record(1);
  const std::vector<MisfitCause> causes =
      misfit_causes(ProjectedLikelihood(plain), the.bowed.truth);
  const auto drift = std::ranges::find(causes, kDrift, &MisfitCause::name);
  ASSERT_NE(drift, causes.end());
  for (const double amplitude : {-4e-4, 4e-4}) {
    WhitenedRecord record = plain;
    for (std::size_t k = 0; k < record.bins; ++k) {
      record.left.set(k, plain.left.at(k) + amplitude * drift->columns[0].left.at(k));
      record.right.set(k, plain.right.at(k) + amplitude * drift->columns[0].right.at(k));
    }
    const ScoreTest found = the.tests(record).at(std::string(kDrift));
    // S is the square of the amplitude in its deviations: four of them.
    const double deviation = std::abs(found.amplitude) / std::sqrt(found.statistic);
    EXPECT_LT(deviation, 1e-4);
    EXPECT_NEAR(found.amplitude, amplitude, 4.0 * deviation);
    EXPECT_TRUE(found.named());
  }
}

}  // namespace
}  // namespace modcal::score_tests_test
