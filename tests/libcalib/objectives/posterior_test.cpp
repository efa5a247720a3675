#include "libcalib/objectives/posterior.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/objectives/frequency_prior.hpp"
#include "tests/libcalib/calibration_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::posterior_test {
namespace {

using Names = std::vector<std::string>;

// 1 + B n² = 1.16 and 2.44.
TEST(WithPriors, OfAVeryStiffStringHasTheSlopesOfItsLaw) {
  Problem problem;
  problem.model = with_frequency_errors(paper_truth(12, 1e-2), 0.01, 2);
  problem.parameters.law_width = 0.02;
  const ParameterSet parameters(problem.model, Names{"f_4", "f_12", "f0", "B"});
  const std::shared_ptr<const ObjectiveFunction> measured =
      FrequencyPrior({.modes = {1, 2}, .frequencies = {190.0, 410.0}, .deviations = {1.0, 2.0}})
          .bind(exact_data(problem.model, 3200, 12800.0, 196.0), parameters);
  const auto posterior = with_priors(measured, problem, parameters, 1e-3);
  ASSERT_EQ(posterior->residual_count(), 4u);
  const std::vector<double> x = parameters.start();
  std::vector<double> r(4);
  posterior->evaluate(x, {.residuals = r.data()});
  EXPECT_NEAR(r[2], std::log(x[0] / (4.0 * x[2] * std::sqrt(1.0 + 16.0 * x[3]))) / 0.02, 1e-11);
  EXPECT_NEAR(r[3], std::log(x[1] / (12.0 * x[2] * std::sqrt(1.0 + 144.0 * x[3]))) / 0.02, 1e-11);
  // Any output alone is what it is beside the others.
  std::vector<double> alone(16), jacobian(16), gradient(4);
  posterior->evaluate(x, {.gradient = gradient.data(), .jacobian = jacobian.data()});
  posterior->evaluate(x, {.jacobian = alone.data()});
  EXPECT_EQ(alone, jacobian);
  // Third derivatives over a thousandth of the scale, some 1e-5.
  expect_slopes_match(*posterior, parameters.variables(), x, 1e-3, 1e-4);
}

}  // namespace
}  // namespace modcal::posterior_test
