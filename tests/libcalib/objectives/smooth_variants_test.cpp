// Smooth variants and sums of the objectives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "libcalib/objectives/force_difference.hpp"
#include "libcalib/objectives/smooth_spectral_peak.hpp"
#include "libcalib/objectives/spectral_peak.hpp"
#include "libcalib/objectives/weighted_sum.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/calibration_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::smooth_variants_test {
namespace {

using Names = std::vector<std::string>;

struct Case {
  CalibrationData data = exact_data(paper_truth(12), 3200, 6400.0, 196.0);
  ParameterSet parameters{with_frequency_errors(paper_truth(12), 0.01, 2),
                          Names{"x_c", "f_4", "f0", "B"}};
};

double half_square_of_residuals(const ObjectiveFunction& function, std::span<const double> x) {
  std::vector<double> r(function.residual_count());
  function.evaluate(x, {.residuals = r.data()});
  return 0.5 * std::inner_product(r.begin(), r.end(), r.begin(), 0.0);
}

TEST(ContactLocationSquares, IsHalfTheSquareWithItsJacobian) {
  const Case given;
  const auto squares = ContactLocationSquares({}).bind(given.data, given.parameters);
  const auto plain = ContactLocation({}).bind(given.data, given.parameters);
  const auto x = given.parameters.start();
  const double expected = 0.5 * std::pow(plain->value(x), 2);
  // Sums of 3000 bins in another order.
  EXPECT_NEAR(squares->value(x), expected, 1e-12 * expected);
  EXPECT_NEAR(half_square_of_residuals(*squares, x), expected, 1e-12 * expected);
  expect_slopes_match(*squares, given.parameters.variables(), x, 1e-5, 1e-5);
}

TEST(ContactLocationSquares, NeedsTheContact) {
  const Case given;
  const ParameterSet frequency(paper_truth(12), Names{"f_1"});
  EXPECT_THROW(ContactLocationSquares({}).bind(given.data, frequency), InvalidInput);
}

TEST(SmoothSpectralPeak, TendsToTheIntegralFromAboveAndHasAJacobian) {
  const Case given;
  const auto x = given.parameters.start();
  const double limit = SpectralPeak({}).bind(given.data, given.parameters)->value(x);
  double previous = std::numeric_limits<double>::infinity();
  for (const double softening : {1e-1, 1e-2, 1e-3, 1e-5}) {
    const auto smooth =
        SmoothSpectralPeak({.softening = softening}).bind(given.data, given.parameters);
    const double value = smooth->value(x);
    EXPECT_GT(value, limit);
    // √(|F|² + δ²) − |F| ≤ δ, δ the share `softening` of the mean |F|.
    EXPECT_LE(value, limit * (1.0 + 1.5 * softening));
    EXPECT_LT(value, previous);
    EXPECT_NEAR(half_square_of_residuals(*smooth, x), value, 1e-12 * value);
    previous = value;
  }
  const auto smooth = SmoothSpectralPeak({}).bind(given.data, given.parameters);
  expect_slopes_match(*smooth, given.parameters.variables(), x, 1e-6, 1e-4);
}

TEST(SmoothSpectralPeak, WorksWithOneReactionAndRefusesNoSoftening) {
  Case given;
  given.data.reactions[1].clear();
  const auto smooth = SmoothSpectralPeak({}).bind(given.data, given.parameters);
  expect_slopes_match(*smooth, given.parameters.variables(), given.parameters.start(), 1e-6, 1e-4);
  EXPECT_THROW(SmoothSpectralPeak({.softening = 0.0}), InvalidInput);
  EXPECT_THROW(SmoothSpectralPeak({.half_band = 1.0}), InvalidInput);
}

WeightedSum sum_of(const std::vector<std::pair<double, std::string>>& terms) {
  WeightedSum::Options options;
  for (const auto& [weight, name] : terms) {
    options.terms.emplace_back();
    options.terms.back().weight = weight;
    options.terms.back().objective.select(name);
  }
  return WeightedSum(options);
}

TEST(WeightedSum, IsTheSumOfItsTermsWithGradientAndJacobian) {
  const Case given;
  const auto x = given.parameters.start();
  const auto sum = sum_of({{2.0, "force_mismatch"}, {0.5, "contact_location_squares"}})
                       .bind(given.data, given.parameters);
  const auto force = ForceMismatch({}).bind(given.data, given.parameters);
  const auto contact = ContactLocationSquares({}).bind(given.data, given.parameters);
  const double expected = 2.0 * force->value(x) + 0.5 * contact->value(x);
  EXPECT_DOUBLE_EQ(sum->value(x), expected);
  EXPECT_TRUE(sum->capabilities().least_squares);
  EXPECT_EQ(sum->residual_count(), force->residual_count() + contact->residual_count());
  EXPECT_NEAR(half_square_of_residuals(*sum, x), expected, 1e-12 * expected);
  expect_slopes_match(*sum, given.parameters.variables(), x, 1e-6, 1e-4);
}

TEST(WeightedSum, GivesOnlyWhatAllTermsGive) {
  const Case given;
  const auto sum =
      sum_of({{1.0, "force_mismatch"}, {1e-3, "spectral_peak"}}).bind(given.data, given.parameters);
  EXPECT_TRUE(sum->capabilities().gradient);
  EXPECT_FALSE(sum->capabilities().least_squares);
  EXPECT_EQ(sum->residual_count(), 0u);
  expect_slopes_match(*sum, given.parameters.variables(), given.parameters.start(), 1e-6, 1e-4);
}

void expect_same(const Capabilities& stated, const Capabilities& bound, std::string_view name) {
  EXPECT_EQ(stated.gradient, bound.gradient) << name;
  EXPECT_EQ(stated.least_squares, bound.least_squares) << name;
  EXPECT_EQ(stated.sum_of_squares(), bound.sum_of_squares()) << name;
}

TEST(Objectives, SayBeforehandWhatTheirFunctionsCompute) {
  const Case given;
  for (const std::string name : {"contact_location", "contact_location_squares", "force_mismatch",
                                 "smooth_spectral_peak", "spectral_peak"}) {
    const auto objective = Choice<Objective>(name).make();
    expect_same(objective->capabilities(),
                objective->bind(given.data, given.parameters)->capabilities(), name);
    for (const std::string other : {"force_mismatch", "spectral_peak"}) {
      const WeightedSum sum = sum_of({{1.0, name}, {2.0, other}});
      expect_same(sum.capabilities(), sum.bind(given.data, given.parameters)->capabilities(), name);
    }
  }
  // Residuals without slopes stay residuals in a sum.
  const Capabilities mixed =
      sum_of({{1.0, "innovation_misfit"}, {1.0, "frequency_prior"}}).capabilities();
  EXPECT_TRUE(mixed.sum_of_squares());
  EXPECT_FALSE(mixed.least_squares);
  EXPECT_FALSE(mixed.gradient);
}

TEST(Objectives, SmoothVariantsNameWhatTheyAreVariantsOf) {
  for (const std::string name : {"contact_location", "spectral_peak"}) {
    bool found = false;
    for (const auto& entry : Objective::registry()) {
      found = found || entry.summary.find("smooth variant of " + name) != std::string_view::npos;
    }
    EXPECT_TRUE(found) << name;
  }
}

TEST(WeightedSum, IsWhiteWhereAllItsTermsAreWithTheWeightOne) {
  EXPECT_TRUE(sum_of({{1.0, "joint_likelihood"}, {1.0, "frequency_prior"}}).whitened());
  EXPECT_FALSE(sum_of({{1.0, "joint_likelihood"}, {2.0, "frequency_prior"}}).whitened());
  EXPECT_FALSE(sum_of({{1.0, "joint_likelihood"}, {1.0, "force_mismatch"}}).whitened());
}

TEST(WeightedSum, WithoutTermsSaysThatItHasNone) {
  const std::vector<std::string> names = {"f0"};
  try {
    sum_of({}).require_moved_by(names);
    FAIL();
  } catch (const InvalidInput& refusal) {
    EXPECT_THAT(refusal.what(), testing::HasSubstr("without terms"));
  }
}

TEST(WeightedSum, ScansTheSumOfTheParts) {
  const Case given;
  const ParameterSet parameters(paper_truth(12), Names{"f_4", "x_c"});
  const auto sum =
      sum_of({{2.0, "spectral_peak"}, {3.0, "force_mismatch"}}).bind(given.data, parameters);
  const auto peak = SpectralPeak({}).bind(given.data, parameters);
  const auto force = ForceMismatch({}).bind(given.data, parameters);
  const auto x = parameters.start();
  const std::vector<double> candidates = {0.99 * x[0], x[0], 1.01 * x[0]};
  std::vector<double> values(3), of_peak(3), of_force(3);
  const auto scanner = sum->scanner(x);
  scanner->scan(0, candidates, values);
  peak->scanner(x)->scan(0, candidates, of_peak);
  force->scanner(x)->scan(0, candidates, of_force);
  for (std::size_t j = 0; j < 3; ++j) {
    EXPECT_DOUBLE_EQ(values[j], 2.0 * of_peak[j] + 3.0 * of_force[j]);
  }
  scanner->move(0, candidates[0]);
  scanner->refresh();
  std::vector<double> moved(3);
  scanner->scan(1, std::vector<double>{0.029, 0.03, 0.031}, moved);
  EXPECT_NE(moved[0], moved[1]);
}

TEST(WeightedSum, RefusesWhatIsNoSum) {
  const Case given;
  EXPECT_THROW(sum_of({}).bind(given.data, given.parameters), InvalidInput);
  EXPECT_THROW(sum_of({{0.0, "spectral_peak"}}), InvalidInput);
  WeightedSum::TermChoice term;
  EXPECT_THROW(term.select("weighted_sum"), InvalidInput);
  EXPECT_THAT(term.names(), testing::Not(testing::Contains("weighted_sum")));
}

}  // namespace
}  // namespace modcal::smooth_variants_test
