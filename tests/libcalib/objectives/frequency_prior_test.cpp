// Modal frequencies measured otherwise, as a prior.
#include "libcalib/objectives/frequency_prior.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/objectives/weighted_sum.hpp"
#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/calibration_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::frequency_prior_test {
namespace {

using Names = std::vector<std::string>;

CalibrationData any_data() { return exact_data(paper_truth(12), 3200, 6400.0, 196.0); }

TEST(FrequencyPrior, IsHalfTheSquareOfTheDistanceInDeviations) {
  const ParameterSet parameters(paper_truth(12), Names{"f_3", "x_c"});
  const double third = parameters.initial().basis.frequency(2);
  const double fifth = parameters.initial().basis.frequency(4);
  const auto prior =
      FrequencyPrior(
          {.modes = {3, 5}, .frequencies = {third + 0.5, fifth - 0.3}, .deviations = {0.25, 0.1}})
          .bind_term(any_data(), parameters);
  std::vector<double> r(2);
  double value = 0.0;
  prior->evaluate(parameters.start(), {.value = &value, .residuals = r.data()});
  // Differences of frequencies near 1000 Hz, rounded to 1e-13 Hz and divided by 0.1.
  EXPECT_NEAR(r[0], -2.0, 1e-11);
  EXPECT_NEAR(r[1], 3.0, 1e-11);
  EXPECT_NEAR(value, 6.5, 1e-10);
}

TEST(FrequencyPrior, HasTheSlopesOfLawAndFrequencies) {
  const ParameterSet parameters(with_frequency_errors(paper_truth(12, 1e-4), 0.01, 2),
                                Names{"f_4", "f0", "B"});
  const auto prior = FrequencyPrior({.modes = {1, 4, 12},
                                     .frequencies = {196.0, 784.0, 2360.0},
                                     .deviations = {0.1, 0.2, 0.5}})
                         .bind(any_data(), parameters);
  // B enters through a root: differences over 1e-5 of its scale are right to some 1e-6.
  expect_slopes_match(*prior, parameters.variables(), parameters.start(), 1e-3, 1e-5);
}

TEST(FrequencyPrior, InASumMovesTheLawToWhereTwoMeasurementsMeet) {
  // Two measurements of f_2 with precisions 1 and 3: the mean lies three quarters of the way.
  const ParameterSet parameters(paper_truth(12), Names{"f_2"});
  const double start = parameters.start()[0];
  WeightedSum::Options sum;
  sum.terms.resize(2);
  sum.terms[0].objective.assign(Choice<Objective>::of<FrequencyPrior>(
      "frequency_prior", {.modes = {2}, .frequencies = {start}, .deviations = {std::sqrt(3.0)}}));
  sum.terms[1].objective.assign(Choice<Objective>::of<FrequencyPrior>(
      "frequency_prior", {.modes = {2}, .frequencies = {start + 1.0}, .deviations = {1.0}}));
  const auto function = WeightedSum(sum).bind(any_data(), parameters);
  const auto found =
      CeresOptimizer({}).minimize(*function, parameters.variables(), {.evaluations = 50});
  EXPECT_NEAR(found.x[0], start + 0.75, 1e-9 * start);
}

TEST(FrequencyPrior, RefusesWhatIsNoMeasurement) {
  using Options = FrequencyPrior::Options;
  EXPECT_THROW(FrequencyPrior(Options{.modes = {1}, .frequencies = {196.0}}), InvalidInput);
  EXPECT_THROW(FrequencyPrior(Options{.modes = {1}, .frequencies = {196.0}, .deviations = {0.0}}),
               InvalidInput);
  EXPECT_THROW(FrequencyPrior(Options{
                   .modes = {1, 1}, .frequencies = {196.0, 196.0}, .deviations = {1.0, 1.0}}),
               InvalidInput);
  const ParameterSet parameters(paper_truth(12), Names{"f_2"});
  EXPECT_THROW(FrequencyPrior(Options{}).bind(any_data(), parameters), InvalidInput);
  EXPECT_THROW(FrequencyPrior(Options{.modes = {13}, .frequencies = {2600.0}, .deviations = {1.0}})
                   .bind(any_data(), parameters),
               InvalidInput);
  WeightedSum::TermChoice term;
  EXPECT_THROW(term.assign(Choice<Objective>("weighted_sum")), InvalidInput);
}

}  // namespace
}  // namespace modcal::frequency_prior_test
