#include "libcalib/likelihood/expected_limit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "libcalib/likelihood/mode_verdict.hpp"
#include "libcalib/likelihood/string_unknowns.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal {
namespace {

constexpr double kAutomatic = std::numeric_limits<double>::quiet_NaN();

TEST(ExpectedLimit, IsThatOfAnIndependentPrototype) {
  // f0 [Hz], B, x_c [m], damping factor at 1 % noise, two digits each; 4 % for those digits and for
  // another integrator behind the prototype's trajectory.
  struct Case {
    double contact, inharmonicity, law[4], first_mode;
  };
  for (const Case& c : {Case{0.03, 0.0, {4.2e-4, 4.4e-9, 2.94e-7, 1.4e-3}, 7.6e-6},
                        Case{0.0285, 1.39e-4, {6.2e-4, 2.1e-8, 7.14e-7, 1.7e-3}, 7.1e-6}}) {
    const BowedCase bowed = bowed_case(c.contact, c.inharmonicity, 1.0);
    const ExpectedLimit limit =
        expected_limit(bowed.truth, noisy(bowed, 0.01, 1, false), kAutomatic, 2e-3);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(limit.law[i] / c.law[i], 1.0, 0.04) << i;
    EXPECT_NEAR(limit.modes[0].deviation / c.first_mode, 1.0, 0.04);
  }
}

class PapersString : public testing::Test {
 protected:
  BowedCase bowed = bowed_case(0.03, 0.0, 0.25);
  ExpectedLimit at(double level) const {
    return expected_limit(bowed.truth, noisy(bowed, level, 1, false), kAutomatic, 2e-3);
  }
};

TEST_F(PapersString, IsTheInverseOfTheInformationAndInProportionToTheNoise) {
  const ExpectedLimit limit = at(0.01);
  const ExpectedLimit louder = at(0.04);
  const ProjectedLikelihood whole(WhitenedRecord::of(
      noisy(bowed, 0.01, 1, false), 0.0, likelihood_band(bowed.truth, kAutomatic, 51200.0)));
  const StringUnknowns law = StringUnknowns::law(bowed.truth, 196.0, 0.0);
  const Eigen::MatrixXd covariance =
      (2.0 * whole.evaluate(bowed.truth, law.columns(law.start())).information).inverse();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const double unit = i == 0 ? 196.0 : 1.0;
    EXPECT_NEAR(limit.law[i], unit * std::sqrt(covariance(j, j)), 1e-6 * limit.law[i]);
    EXPECT_NEAR(louder.law[i], 4.0 * limit.law[i], 1e-6 * louder.law[i]);
    EXPECT_NEAR(limit.law_correlation[i][i], 1.0, 1e-12);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_NEAR(limit.law_correlation[i][k], limit.law_correlation[k][i], 1e-12);
      EXPECT_LT(std::abs(limit.law_correlation[i][k]), 1.0);
    }
  }
  ASSERT_EQ(limit.singular_values.size(), 50u);
  EXPECT_TRUE(std::is_sorted(limit.singular_values.rbegin(), limit.singular_values.rend()));
}

TEST(ExpectedLimit, CountsWhatTheUnknownForceCosts) {
  // B of a string whose resonances leave the lines of the force: 1.10 bounds at 10 % noise under
  // w = S/(1 + S) with the true S, as an independent program has it; nothing where noise is low.
  // The paper's string has its resonances on the lines. Two digits.
  const auto loss = [](const BowedCase& bowed, double level, std::size_t i) {
    const ExpectedLimit limit =
        expected_limit(bowed.truth, noisy(bowed, level, 1, false), kAutomatic, 2e-3);
    return limit.law_attainable[i] / limit.law[i];
  };
  const BowedCase second = bowed_case(0.0285, 1.39e-4, 1.0);
  EXPECT_NEAR(loss(second, 0.1, 1), 1.10, 0.015);
  EXPECT_NEAR(loss(second, 0.1, 0), 1.02, 0.01);
  EXPECT_NEAR(loss(second, 0.001, 1), 1.0, 0.005);
  EXPECT_NEAR(loss(bowed_case(0.03, 0.0, 1.0), 0.1, 1), 1.0, 0.015);
}

TEST_F(PapersString, HasBlindModesWithTheirReasons) {
  const ExpectedLimit limit = at(0.01);
  for (const std::size_t n : {11u, 22u, 33u, 44u}) {
    EXPECT_NE(limit.modes[n - 1].source, ModeSource::kIdentified) << n;
    EXPECT_EQ(limit.modes[n - 1].reason, WeakReason::kNode) << n;
  }
  EXPECT_EQ(limit.modes[0].source, ModeSource::kIdentified);
  EXPECT_EQ(limit.modes[0].reason, WeakReason::kNone);
  EXPECT_GE(limit.blind_modes, 4u);
  // Ten times the noise takes the modes at an antinode, whose ends react alike.
  const ExpectedLimit louder = at(0.3);
  EXPECT_GT(louder.blind_modes, limit.blind_modes);
  EXPECT_EQ(louder.modes[4].reason, WeakReason::kAntinode);
}

TEST_F(PapersString, ProposesContactsOffTheNodes) {
  const std::vector<double> contacts = contacts_without_blind_modes(bowed.truth, 6.6e-3, 0.1, 4);
  ASSERT_FALSE(contacts.empty());
  const auto least = [&](double contact) {
    double shape = 1.0;
    for (const double value : bowed.truth.basis.shape_at(contact)) {
      shape = std::min(shape, std::abs(value));
    }
    return shape;
  };
  for (const double contact : contacts) {
    EXPECT_LE(std::abs(contact - 0.03), 6.6e-3);
    EXPECT_GT(least(contact), 10.0 * least(0.03));
  }
}

TEST_F(PapersString, RefusesWhatIsNoPrior) {
  EXPECT_THROW(expected_limit(bowed.truth, noisy(bowed, 0.01, 1, false), kAutomatic, 0.0),
               InvalidInput);
  EXPECT_THROW(contacts_without_blind_modes(bowed.truth, -1.0, 0.1, 4), InvalidInput);
}

}  // namespace
}  // namespace modcal
