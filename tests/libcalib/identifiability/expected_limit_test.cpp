#include "libcalib/identifiability/expected_limit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/likelihood/pluck_record_case.hpp"

namespace modcal::expected_limit_test {
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
    // But for what is known of the end state, whatever the noise: 1e-4 of the limit.
    EXPECT_NEAR(louder.law[i], 4.0 * limit.law[i], 2e-4 * louder.law[i]);
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

LimitCase case_of(const BowedCase& bowed, double level) {
  return {.truth = bowed.truth,
          .strokes = {noisy(bowed, level, 1, false)},
          .contacts = {bowed.truth.contact},
          .plucks = {},
          .highest_frequency = kAutomatic,
          .law_width = 2e-3,
          .unknowns = {}};
}

double law_of(const ExpectedLimit& limit, const std::string& parameter) {
  return limit.find(parameter)->law;
}

TEST_F(PapersString, TwoStrokesHaveTwiceTheInformation) {
  // Each has an x_c of its own, which leaves of what is shared the same in both: exactly half the
  // variance. Of its own x_c a stroke knows more by what the other tells of the rest.
  const LimitCase one = case_of(bowed, 0.01);
  LimitCase two = one;
  two.strokes.push_back(two.strokes.front());
  two.contacts.push_back(two.contacts.front());
  const ExpectedLimit alone = expected_limit(one), together = expected_limit(two);
  for (const char* name : {"f0", "B", "damping"}) {
    EXPECT_NEAR(law_of(together, name) / law_of(alone, name), std::sqrt(0.5), 1e-6) << name;
  }
  EXPECT_NEAR(law_of(together, "x_c 2") / law_of(together, "x_c"), 1.0, 1e-6);
  EXPECT_LE(law_of(together, "x_c"), law_of(alone, "x_c") * (1.0 + 1e-9));
  EXPECT_GE(law_of(together, "x_c"), std::sqrt(0.5) * law_of(alone, "x_c"));
  EXPECT_EQ(alone.find("x_c 2"), nullptr);
  for (std::size_t n = 0; n < 50; ++n) {
    EXPECT_LE(together.modes[n].deviation, alone.modes[n].deviation * (1.0 + 1e-9)) << n + 1;
  }
}

TEST_F(PapersString, APluckLeavesNoModeBlind) {
  LimitCase both = case_of(bowed, 0.01);
  EXPECT_GE(expected_limit(both).blind_modes, 4u);
  both.plucks.push_back(plucked_records(0.0, 0.25, 0.01, 0));
  const ExpectedLimit limit = expected_limit(both);
  EXPECT_EQ(limit.blind_modes, 0u);
  // The same from the likelihoods of both records, their informations added by hand.
  const double highest = likelihood_band(bowed.truth, kAutomatic, 51200.0);
  const StringUnknowns free = StringUnknowns::frequencies(bowed.truth);
  const LikelihoodColumns columns = free.columns(free.start());
  const ProjectedLikelihood stroke(WhitenedRecord::of(both.strokes[0], 0.0, highest));
  const PluckLikelihood pluck(WhitenedRecord::of(both.plucks[0], 0.0, highest));
  const Eigen::MatrixXd information =
      2.0 * (stroke.evaluate(bowed.truth, columns).information +
             pluck.evaluate(bowed.truth, columns).information) +
      free.prior(free.start(), {Eigen::VectorXd::Constant(50, 2e-3), 0.0}).precision;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::VectorXd deviation = scaled.inverse().diagonal().cwiseSqrt().array() * scale.array();
  for (const std::size_t n : {1u, 11u, 22u, 33u, 44u}) {
    EXPECT_EQ(limit.modes[n - 1].source, ModeSource::kIdentified) << n;
    EXPECT_NEAR(limit.modes[n - 1].deviation / deviation[static_cast<Eigen::Index>(n - 1)], 1.0,
                1e-6);
  }
  EXPECT_NEAR(limit.contact / deviation[free.contact()], 1.0, 1e-6);
}

TEST_F(PapersString, SensorsAndDampingAreExpectedAsTheFitReportsThem) {
  // Noise in the slopes and the weights are nothing at 0.1 %: over 300 draws the deviation reported
  // is 1.000 of the limit and scatters by 0.001. Ten of these. That of x_c scatters by 0.04 with
  // the width that a draw finds for the modes at a node: 0.03 of this one.
  LimitCase question = case_of(bowed, 1e-3);
  question.unknowns = {.damping = "power"};
  question.unknowns.sensor[Sensor::kGain].free = question.unknowns.sensor[Sensor::kDelay].free =
      question.unknowns.sensor[Sensor::kCorner].free = true;
  const ExpectedLimit limit = expected_limit(question);
  const NoisyRecords records = noisy(bowed, 1e-3, 5);
  const ContinuationResult fit = calibrate_by_continuation(
      bowed.truth,
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate),
      {.law_width = 2e-3,
       .left_noise = records.deviation[0],
       .right_noise = records.deviation[1],
       .unknowns = question.unknowns,
       .restarts = 0});
  ASSERT_TRUE(fit.frequencies_free);
  constexpr const char* kSensors[] = {"gain", "delay", "corner"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(limit.find(kSensors[i])->free / fit.sensor_deviation[i], 1.0, 0.01) << kSensors[i];
    // Whoever knows that the frequencies follow a law knows more of the sensors.
    EXPECT_LE(law_of(limit, kSensors[i]), limit.find(kSensors[i])->free) << kSensors[i];
  }
  EXPECT_NEAR(limit.find("x_c")->free / fit.contact_deviation, 1.0, 0.03);
  EXPECT_NEAR(limit.find("damping")->free / fit.damping_deviation, 1.0, 0.01);
  EXPECT_NEAR(limit.find("damping_power")->free / fit.damping_power_deviation, 1.0, 0.01);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(limit.law_attainable[i] / fit.law.deviation[i], 1.0, 0.01) << i;
  }
}

TEST_F(PapersString, TheLimitHasNoStepWhereTheSensorsBecomeEqual) {
  // A corner of 0.1 mHz turns a record of 0.25 s by 2π·10⁻⁴·0.25 = 1.6e-4 at the most.
  LimitCase question = case_of(bowed, 0.01);
  question.unknowns.sensor[Sensor::kGain].free = question.unknowns.sensor[Sensor::kCorner].free =
      true;
  const ExpectedLimit equal = expected_limit(question);
  question.truth.sensors.corner = 2.0 * std::numbers::pi * 1e-4;
  const ExpectedLimit beside = expected_limit(question);
  for (const char* name : {"f0", "B", "x_c", "damping", "gain", "corner"}) {
    EXPECT_NEAR(law_of(equal, name) / law_of(beside, name), 1.0, 1e-3) << name;
    EXPECT_NEAR(equal.find(name)->attainable / beside.find(name)->attainable, 1.0, 1e-3) << name;
  }
}

TEST_F(PapersString, APriorAddsItsInformation) {
  // A prior as wide as what the data alone tell halves the variance.
  LimitCase question = case_of(bowed, 0.01);
  question.unknowns.sensor[Sensor::kGain].free = true;
  const double alone = law_of(expected_limit(question), "gain");
  question.unknowns.priors = {{.parameter = "gain", .mean = 1.0, .deviation = alone}};
  EXPECT_NEAR(law_of(expected_limit(question), "gain") / alone, std::sqrt(0.5), 1e-6);
  question.unknowns.priors = {{.parameter = "delay", .mean = 0.0, .deviation = 1e-6}};
  EXPECT_THROW(expected_limit(question), InvalidInput);  // it is not free
}

TEST_F(PapersString, HasARowForWhatIsFreeAlone) {
  LimitCase question = case_of(bowed, 0.01);
  question.unknowns.damping = "fixed";
  const ExpectedLimit fixed = expected_limit(question);
  EXPECT_EQ(fixed.find("damping"), nullptr);
  EXPECT_EQ(fixed.law[3], 0.0);
  question.unknowns.damping = "each";
  const ExpectedLimit each = expected_limit(question);
  ASSERT_NE(each.find("zeta_50"), nullptr);
  for (std::size_t n = 1; n <= 50; ++n) {
    const ParameterLimit* ratio = each.find("zeta_" + std::to_string(n));
    EXPECT_TRUE(std::isnan(ratio->law));
    // Not wider than its prior of 30 % about the stated 1e-3.
    EXPECT_GT(ratio->free, 0.0);
    EXPECT_LE(ratio->free, 3e-4 * (1.0 + 1e-9)) << n;
  }
  EXPECT_LT(each.find("zeta_1")->free, 1e-4);
}

TEST_F(PapersString, WhatIsFixedHasNoRowAndIsKnownToTheOthers) {
  LimitCase question = case_of(bowed, 0.01);
  const ExpectedLimit all = expected_limit(question);
  question.unknowns.fixed = {{.parameter = "x_c", .value = 0.03},
                             {.parameter = "f0", .value = 196.0}};
  const ExpectedLimit known = expected_limit(question);
  EXPECT_EQ(known.find("x_c"), nullptr);
  EXPECT_EQ(known.find("f0"), nullptr);
  EXPECT_EQ(known.law[2], 0.0);
  // A Gaussian's conditional variance.
  const auto& rho = all.law_correlation;
  const double explained =
      (rho[0][1] * rho[0][1] + rho[1][2] * rho[1][2] - 2.0 * rho[0][1] * rho[1][2] * rho[0][2]) /
      (1.0 - rho[0][2] * rho[0][2]);
  EXPECT_NEAR(known.law[1] / all.law[1], std::sqrt(1.0 - explained), 1e-6);
  question.unknowns.fixed = {{.parameter = "f_11", .value = 11.0 * 196.0}};
  const ExpectedLimit one = expected_limit(question);
  EXPECT_EQ(one.modes[10].source, ModeSource::kFixed);
  EXPECT_EQ(one.blind_modes + 1, all.blind_modes);
}

TEST_F(PapersString, ARecordsOwnSensorsHaveARowEach) {
  LimitCase question = case_of(bowed, 0.01);
  question.plucks.push_back(plucked_records(0.0, 0.25, 0.01, 0));
  question.unknowns.sensor[Sensor::kGain].free = true;
  const ExpectedLimit shared = expected_limit(question);
  question.unknowns.per_record = {"x_c", "gain"};
  const ExpectedLimit own = expected_limit(question);
  EXPECT_EQ(shared.find("gain 2"), nullptr);
  ASSERT_NE(own.find("gain 2"), nullptr);
  // Whoever takes the pluck's gain for the stroke's knows it better than either record.
  EXPECT_LT(law_of(shared, "gain"), law_of(own, "gain"));
  EXPECT_LT(law_of(shared, "gain"), law_of(own, "gain 2"));
}

TEST_F(PapersString, RefusesWhatIsNoPrior) {
  LimitCase question = case_of(bowed, 0.01);
  question.contacts.clear();
  EXPECT_THROW(expected_limit(question), InvalidInput);
  EXPECT_THROW(expected_limit(bowed.truth, noisy(bowed, 0.01, 1, false), kAutomatic, 0.0),
               InvalidInput);
  EXPECT_THROW(contacts_without_blind_modes(bowed.truth, -1.0, 0.1, 4), InvalidInput);
}

}  // namespace
}  // namespace modcal::expected_limit_test
