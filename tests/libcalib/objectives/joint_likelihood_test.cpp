#include "libcalib/objectives/joint_likelihood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal {
namespace {

using Names = std::vector<std::string>;

class JointLikelihoodTest : public testing::Test {
 protected:
  BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.2);
  NoisyRecords records = noisy(bowed, 0.02, 5);
  CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);
  JointLikelihood objective(double damping = 0.0) const {
    JointLikelihood::Options options;
    options.damping = damping;
    options.left_noise = records.deviation[0];
    options.right_noise = records.deviation[1];
    return JointLikelihood(options);
  }
  ModelPoint near_truth() const {
    ModelPoint point = bowed.truth;
    for (double& omega : point.basis.omega) omega *= 1.0 + 2e-5;
    point.contact += 1e-5;
    return point;
  }
};

TEST_F(JointLikelihoodTest, WhitensItsResiduals) {
  const ParameterSet parameters(bowed.truth, Names{"f0", "B", "x_c"});
  const auto function = objective().bind(data, parameters);
  std::vector<double> residuals(function->residual_count());
  double value = 0.0;
  function->evaluate(parameters.start(), {.value = &value, .residuals = residuals.data()});
  const double sum = std::inner_product(residuals.begin(), residuals.end(), residuals.begin(), 0.0);
  EXPECT_NEAR(value, 0.5 * sum, 1e-10 * value);
  // χ² of some 4100 residuals less 100 end states: sd √(2/4000) = 0.022, four of them.
  EXPECT_NEAR(sum / (static_cast<double>(residuals.size()) - 100.0), 1.0, 0.09);
  // Quarters of the band alike: twice the standard deviation, four of them. Neighbors apart:
  // correlation 0 ± 1/√4100.
  const std::size_t quarter = residuals.size() / 4;
  double neighbors = 0.0;
  for (std::size_t q = 0; q < 4; ++q) {
    const auto begin = residuals.begin() + static_cast<long>(q * quarter);
    const double part = std::inner_product(begin, begin + static_cast<long>(quarter), begin, 0.0);
    EXPECT_NEAR(part / static_cast<double>(quarter), 1.0, 0.18) << q;
  }
  for (std::size_t j = 2; j < residuals.size(); ++j) neighbors += residuals[j] * residuals[j - 2];
  EXPECT_LT(std::abs(neighbors / sum), 5.0 / std::sqrt(static_cast<double>(residuals.size())));
}

TEST_F(JointLikelihoodTest, GradientIsTheDifferenceQuotientAndTheJacobiansOwn) {
  const ParameterSet parameters(near_truth(), Names{"f0", "B", "x_c", "f_3", "f_17"});
  for (const double damping : {0.0, 40.0}) {
    const auto function = objective(damping).bind(data, parameters);
    const std::vector<double> x = parameters.start();
    const std::size_t n = x.size();
    const std::size_t m = function->residual_count();
    std::vector<double> gradient(n), residuals(m), jacobian(m * n);
    function->evaluate(
        x,
        {.gradient = gradient.data(), .residuals = residuals.data(), .jacobian = jacobian.data()});
    // Small shares of a standard deviation: the third derivative does not show.
    const double steps[] = {2e-4, 1e-9, 1e-8, 1e-3, 1e-3};
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<double> above = x, below = x;
      above[i] += steps[i];
      below[i] -= steps[i];
      const double quotient = (function->value(above) - function->value(below)) / (2.0 * steps[i]);
      double own = 0.0, size = 0.0;
      for (std::size_t j = 0; j < m; ++j) {
        own += jacobian[j * n + i] * residuals[j];
        size += jacobian[j * n + i] * jacobian[j * n + i];
      }
      // √(JᵀJ) is a slope of one standard deviation of the noise.
      const double scale = std::sqrt(size);
      EXPECT_NEAR(gradient[i], quotient, 1e-3 * scale) << parameters[i].variable.name;
      EXPECT_NEAR(gradient[i], own, 1e-3 * scale) << parameters[i].variable.name;
    }
  }
}

TEST_F(JointLikelihoodTest, LeadsALeastSquaresSearchToTheTruth) {
  const ParameterSet parameters(near_truth(), Names{"f0", "B", "x_c"});
  const auto function = objective().bind(data, parameters);
  const auto found = CeresOptimizer({}).minimize(*function, parameters.variables(), {});
  // Bounds of 0.2 s at 2 % noise, 5 to 11 times those of 1 s at 1 %; six of the larger.
  EXPECT_NEAR(found.x[0], 196.0, 6.0 * 11.0 * 6.2e-4);
  EXPECT_NEAR(found.x[1], 1.39e-4, 6.0 * 11.0 * 2.1e-8);
  EXPECT_NEAR(found.x[2], 0.0285, 6.0 * 11.0 * 7.14e-7);
}

TEST_F(JointLikelihoodTest, RefusesOneReaction) {
  const CalibrationData one =
      CalibrationData::of_records(records.reactions[0], {}, records.sample_rate);
  const ParameterSet parameters(bowed.truth, Names{"x_c"});
  EXPECT_THROW(objective().bind(one, parameters), InvalidInput);
}

}  // namespace
}  // namespace modcal
