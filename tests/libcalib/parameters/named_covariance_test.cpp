#include "libcalib/parameters/named_covariance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/calibration.hpp"
#include "libcalib/identifiability/expected_limit.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/likelihood/pluck_record_case.hpp"
#include "tests/libcalib/optimizers/staged/as_calibration.hpp"

namespace modcal::named_covariance_test {
namespace {

NamedCovariance three() {
  // Deviations 2, 3 and 0.1; r_12 = 0.8, r_13 = -0.1, r_23 = 0.
  NamedCovariance result{.names = {"f0", "B", "x_c"}, .matrix = Eigen::MatrixXd::Zero(3, 3)};
  result.matrix << 4.0, 4.8, -0.02, 4.8, 9.0, 0.0, -0.02, 0.0, 0.01;
  return result;
}

TEST(NamedCovariance, HasDeviationsAndCorrelations) {
  const NamedCovariance covariance = three();
  EXPECT_EQ(covariance.deviation(1), 3.0);
  EXPECT_NEAR(covariance.correlations()(0, 1), 0.8, 1e-15);
  EXPECT_NEAR(covariance.correlations()(2, 0), -0.1, 1e-15);
  EXPECT_EQ(covariance.correlations()(2, 2), 1.0);
  EXPECT_EQ(covariance.find("x_c"), 2u);
  EXPECT_FALSE(covariance.find("gain"));
}

TEST(NamedCovariance, WhatIsToldLessThanTheNoiseHidesIsUnknownAndNotExact) {
  NamedCovariance covariance = three();
  EXPECT_TRUE(covariance.unknown().empty());
  covariance.matrix(1, 1) = -1e-20;
  EXPECT_TRUE(std::isnan(covariance.deviation(1)));
  EXPECT_EQ(covariance.unknown(), std::vector<std::string>{"B"});
}

TEST(NamedCovariance, SingularValuesAreThoseOfTwoCorrelatedParameters) {
  // R of two has the eigenvalues 1 + r and 1 - r.
  NamedCovariance pair{.names = {"f0", "B"}, .matrix = Eigen::MatrixXd::Zero(2, 2)};
  pair.matrix << 4.0, 4.8, 4.8, 9.0;
  ASSERT_EQ(pair.singular_values().size(), 2u);
  EXPECT_NEAR(pair.singular_values()[0], 1.0 / std::sqrt(0.2), 1e-12);
  EXPECT_NEAR(pair.singular_values()[1], 1.0 / std::sqrt(1.8), 1e-12);
  EXPECT_NEAR(pair.condition(), 3.0, 1e-12);
  // Units change none of it.
  pair.matrix << 4e-8, 4.8e4, 4.8e4, 9e16;
  EXPECT_NEAR(pair.condition(), 3.0, 1e-12);
  EXPECT_EQ(NamedCovariance{}.condition(), 1.0);
}

TEST(NamedCovariance, WhatIsHeldOrKnownExactlyIsCorrelatedWithNothing) {
  NamedCovariance covariance = three();
  covariance.matrix.row(1).setZero();
  covariance.matrix.col(1).setZero();
  EXPECT_EQ(covariance.deviation(1), 0.0);
  EXPECT_EQ(covariance.correlations()(0, 1), 0.0);
  EXPECT_TRUE(covariance.correlations().allFinite());
}

TEST(NamedCovariance, RaisesAVarianceAndNeverLowersIt) {
  NamedCovariance covariance = three();
  covariance.raise("B", 6.0);
  covariance.raise("f0", 1.0);
  covariance.raise("gain", 1.0);
  EXPECT_EQ(covariance.deviation(1), 6.0);
  EXPECT_EQ(covariance.deviation(0), 2.0);
  EXPECT_NEAR(covariance.correlations()(0, 1), 0.4, 1e-15);
}

TEST(StrongestCorrelations, AreThoseOfWhatIsTakenInOrder) {
  const auto all = strongest_correlations(three(), {true, true, true}, 2);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].first, 0u);
  EXPECT_EQ(all[0].second, 1u);
  EXPECT_NEAR(all[1].correlation, -0.1, 1e-15);
  const auto two = strongest_correlations(three(), {true, false, true}, 9);
  ASSERT_EQ(two.size(), 1u);
  EXPECT_EQ(two[0].second, 2u);
}

double deviation_of(const NamedCovariance& covariance, const std::string& name) {
  const auto place = covariance.find(name);
  EXPECT_TRUE(place) << name;
  return place ? covariance.deviation(*place) : -1.0;
}

// The same number by two ways: 4 ulp are the rounding of s·√v against √(s²v).
void expect_deviations_of_modes(const std::vector<ModeVerdict>& modes,
                                const NamedCovariance& covariance) {
  for (std::size_t n = 0; n < modes.size(); ++n) {
    EXPECT_DOUBLE_EQ(deviation_of(covariance, fmt::format("f_{}", n + 1)),
                     modes[n].frequency * modes[n].deviation)
        << n + 1;
  }
}

class CovarianceOfAFit : public testing::Test {
 protected:
  static constexpr double kLevel = 1e-3;
  BowedCase bowed = bowed_case(0.03, 0.0, 0.25);
  NoisyRecords records = noisy(bowed, kLevel, 5);
  ContinuationOptions options{.law_width = 2e-3,
                              .left_noise = records.deviation[0],
                              .right_noise = records.deviation[1],
                              .restarts = 0};
  CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);
};

TEST_F(CovarianceOfAFit, HasTheDeviationsReportedOnItsDiagonal) {
  options.unknowns.damping = "power";
  options.unknowns.sensor[Sensor::kGain].free = options.unknowns.sensor[Sensor::kDelay].free =
      options.unknowns.sensor[Sensor::kCorner].free = true;
  const ContinuationResult fit = calibrate_by_continuation(bowed.truth, data, options);
  const NamedCovariance& free = fit.covariance;
  ASSERT_EQ(free.size(), 50u + 1u + 2u + 3u);
  expect_deviations_of_modes(fit.modes, free);
  EXPECT_DOUBLE_EQ(deviation_of(free, "x_c"), fit.contact_deviation);
  EXPECT_DOUBLE_EQ(deviation_of(free, "damping"), fit.damping_deviation);
  EXPECT_DOUBLE_EQ(deviation_of(free, "damping_power"), fit.damping_power_deviation);
  EXPECT_DOUBLE_EQ(deviation_of(free, "gain"), fit.sensor_deviation[0]);
  EXPECT_DOUBLE_EQ(deviation_of(free, "delay"), fit.sensor_deviation[1]);
  EXPECT_DOUBLE_EQ(deviation_of(free, "corner"), fit.sensor_deviation[2]);
  constexpr const char* kLaw[] = {"f0", "B", "x_c", "damping"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(deviation_of(fit.law.covariance, kLaw[i]), fit.law.deviation[i]) << kLaw[i];
  }
  // A covariance: no direction has less than none, to rounding.
  EXPECT_TRUE(std::isfinite(free.condition()));
}

TEST_F(CovarianceOfAFit, CorrelatesTheLawAsTheLimitSaysBeforehand) {
  options.frequencies = false;
  const ContinuationResult fit = calibrate_by_continuation(bowed.truth, data, options);
  const ExpectedLimit limit =
      expected_limit(bowed.truth, noisy(bowed, kLevel, 1, false), options.highest_frequency, 2e-3);
  // Weights, noise in the slopes and draws of it move deviations by up to 3 % at 0.1 % noise, the
  // covariance by ε = 6 % of itself in any direction. With C' = C^½(1 + Δ)C^½, |Δ| ≤ ε, and unit
  // vectors u·v = r, r' − r = uᵀΔv − ½r(uᵀΔu + vᵀΔv) lies within ±ε.
  constexpr double kTolerance = 0.06;
  constexpr const char* kLaw[] = {"f0", "B", "x_c", "damping"};
  const Eigen::MatrixXd found = fit.law.covariance.correlations();
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto row = static_cast<Eigen::Index>(*fit.law.covariance.find(kLaw[i]));
      const auto column = static_cast<Eigen::Index>(*fit.law.covariance.find(kLaw[k]));
      EXPECT_NEAR(found(row, column), limit.law_correlation[i][k], kTolerance)
          << kLaw[i] << " with " << kLaw[k];
    }
  }
  EXPECT_GT(std::abs(limit.law_correlation[1][0]), 2.0 * kTolerance) << "tells nothing";
  // The law is all there is.
  EXPECT_EQ(fit.covariance.names, fit.law.covariance.names);
  EXPECT_EQ(fit.covariance.matrix, fit.law.covariance.matrix);
}

TEST_F(CovarianceOfAFit, HasNothingOfWhatIsHeldAndEveryFreeDampingRatio) {
  options.unknowns.damping = "each";
  options.unknowns.fixed = {{.parameter = "x_c"}, {.parameter = "f_7"}};
  const ContinuationResult fit = calibrate_by_continuation(bowed.truth, data, options);
  const NamedCovariance& free = fit.covariance;
  for (const char* name : {"x_c", "f_7", "damping", "damping_power", "gain"}) {
    EXPECT_FALSE(free.find(name)) << name;
  }
  for (std::size_t n = 0; n < 50; ++n) {
    EXPECT_DOUBLE_EQ(deviation_of(free, fmt::format("zeta_{}", n + 1)),
                     fit.model.basis.zeta[n] * fit.ratio_deviations[n])
        << n + 1;
  }
}

TEST_F(CovarianceOfAFit, OfSeveralRecordsNamesThemAsTheParametersDo) {
  const BowedCase second = bowed_case(0.0285, 0.0, 0.25);
  const NoisyRecords other = noisy(second, kLevel, 6);
  const std::vector<CalibrationData> strokes = {
      data, CalibrationData::of_records(other.reactions[0], other.reactions[1], 51200.0)};
  const NoisyRecords rung = plucked_records(0.0, 0.25, kLevel, 7);
  std::vector<CalibrationRecord> all = as_records(strokes);
  all.push_back({.data = CalibrationData::of_records(rung.reactions[0], rung.reactions[1], 51200.0),
                 .noise = rung.deviation,
                 .pluck = true});
  CalibrationOptions calibration = as_calibration(options);
  calibration.parameters.unknowns.sensor[Sensor::kGain].free = true;
  calibration.parameters.unknowns.per_record = {"x_c", "gain"};
  const CalibrationResult result = calibrate(bowed.truth, all, calibration);
  const ContinuationResult& fit = *result.continuation;
  expect_deviations_of_modes(fit.modes, fit.covariance);
  std::size_t others = 0;
  for (const CalibratedParameter& parameter : result.parameters) {
    const bool of_law = parameter.name == "f0" || parameter.name == "B";
    others += of_law ? 0 : 1;
    if (!of_law) {
      EXPECT_DOUBLE_EQ(deviation_of(fit.covariance, parameter.name), parameter.deviation)
          << parameter.name;
      continue;
    }
    // The frequencies follow the law, and the fit of the law alone knows it: the law through the
    // frequencies has its deviation and what the frequencies' scatter may be.
    const double alone = deviation_of(fit.law.covariance, parameter.name);
    EXPECT_GT(parameter.deviation, 0.9 * alone) << parameter.name;
    EXPECT_LT(parameter.deviation, 10.0 * alone) << parameter.name;
  }
  // x_c, x_c 2, damping, gain, gain 2, gain 3.
  EXPECT_EQ(others, 6u);
  EXPECT_EQ(fit.covariance.size(), 50u + others);
}

}  // namespace
}  // namespace modcal::named_covariance_test
