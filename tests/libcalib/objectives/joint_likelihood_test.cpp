#include "libcalib/objectives/joint_likelihood.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "libcalib/objectives/frequency_prior.hpp"
#include "libcalib/objectives/weighted_sum.hpp"
#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/optimizers/tiny_least_squares.hpp"
#include "libcalib/problem/covariance.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::joint_likelihood_test {
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

TEST_F(JointLikelihoodTest, SlopesOfDampingAndSensorsAreDifferenceQuotients) {
  ModelPoint start = near_truth();
  start.sensors = {.gain = 1.01, .delay = 1e-6, .corner = 20.0};
  const ParameterSet parameters(
      start, Names{"gain", "damping", "corner", "zeta_3", "damping_power", "delay", "f_5"});
  for (const double damping : {0.0, 40.0}) {
    const auto function = objective(damping).bind(data, parameters);
    const std::vector<double> x = parameters.start();
    const std::vector<LeastSquaresSlope> slopes = least_squares_slopes(*function, x);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto& [gradient, own, quotient, scale] = slopes[i];
      const double tolerance = 2e-3 * scale * std::sqrt(function->value(x));
      EXPECT_NEAR(gradient, quotient, tolerance) << parameters[i].variable.name;
      EXPECT_NEAR(gradient, own, 1e-3 * scale) << parameters[i].variable.name;
      EXPECT_GT(std::abs(gradient), 10.0 * tolerance) << parameters[i].variable.name;
    }
  }
}

TEST_F(JointLikelihoodTest, MeetsNoStepWhereTheSensorsBecomeEqual) {
  // Two unknowns more or less would move the value by about 1, a slope by its standard deviation.
  const ParameterSet parameters(near_truth(), Names{"gain", "delay", "corner"});
  for (const double damping : {0.0, 40.0}) {
    const auto function = objective(damping).bind(data, parameters);
    const std::size_t m = function->residual_count();
    const auto at = [&](const std::vector<double>& x, std::vector<double>& gradient,
                        std::vector<double>& jacobian) {
      double value = 0.0;
      gradient.resize(3);
      jacobian.resize(3 * m);
      function->evaluate(
          x, {.value = &value, .gradient = gradient.data(), .jacobian = jacobian.data()});
      return value;
    };
    std::vector<double> gradient, jacobian, beside, other;
    const std::vector<double> start = parameters.start();
    ASSERT_EQ(start, (std::vector<double>{1.0, 0.0, 0.0}));
    const double value = at(start, gradient, jacobian);
    for (std::size_t i = 0; i < 3; ++i) {
      double size = 0.0;
      for (std::size_t j = 0; j < m; ++j) size += jacobian[j * 3 + i] * jacobian[j * 3 + i];
      // A millionth of a standard deviation: the value moves by less than 1e-6 times the residual's
      // norm of 90, the slope by 1e-6 of its own standard deviation or, where the columns' change
      // meets the whole residual, some hundred times that.
      std::vector<double> x = start;
      x[i] += 1e-6 / std::sqrt(size);
      EXPECT_NEAR(at(x, beside, other), value, 1e-3) << i;
      for (std::size_t j = 0; j < 3; ++j) {
        double scale = 0.0;
        for (std::size_t k = 0; k < m; ++k) scale += jacobian[k * 3 + j] * jacobian[k * 3 + j];
        EXPECT_NEAR(beside[j], gradient[j], 1e-3 * std::sqrt(scale)) << i << j;
      }
    }
  }
}

TEST_F(JointLikelihoodTest, CornersSlopeAtNoneIsTheDifferenceQuotient) {
  const ParameterSet parameters(near_truth(), Names{"corner"});
  const auto function = objective().bind(data, parameters);
  std::vector<double> gradient(1), residuals(function->residual_count());
  std::vector<double> jacobian(residuals.size());
  function->evaluate(std::vector<double>{0.0},
                     {.gradient = gradient.data(), .jacobian = jacobian.data()});
  const double scale =
      std::sqrt(std::inner_product(jacobian.begin(), jacobian.end(), jacobian.begin(), 0.0));
  // Of one side, the other has no filter: a tenth of a standard deviation, second order below.
  const double step = 0.1 / scale;
  const double first = function->value(std::vector<double>{0.0});
  const double second = function->value(std::vector<double>{step});
  const double third = function->value(std::vector<double>{2.0 * step});
  const double quotient = (4.0 * second - third - 3.0 * first) / (2.0 * step);
  EXPECT_NEAR(gradient[0], quotient, 0.02 * scale);
}

TEST_F(JointLikelihoodTest, FindsDampingAndGain) {
  ModelPoint start = near_truth();
  for (double& zeta : start.basis.zeta) zeta *= 1.2;
  NoisyRecords louder = records;
  for (double& sample : louder.reactions[1]) sample *= 1.02;
  louder.deviation[1] *= 1.02;
  const CalibrationData sensed =
      CalibrationData::of_records(louder.reactions[0], louder.reactions[1], louder.sample_rate);
  const ParameterSet parameters(start, Names{"f0", "B", "x_c", "damping", "gain"});
  const auto function = objective().bind(sensed, parameters);
  const auto found = CeresOptimizer({}).minimize(*function, parameters.variables(), {});
  std::vector<double> jacobian(function->residual_count() * 5);
  function->evaluate(found.x, {.jacobian = jacobian.data()});
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 5, Eigen::RowMajor>> slopes(
      jacobian.data(), static_cast<Eigen::Index>(function->residual_count()), 5);
  const Eigen::MatrixXd scale = slopes.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = slopes * scale.row(0).asDiagonal();
  const Eigen::VectorXd sd =
      ((scaled.transpose() * scaled).inverse().diagonal().cwiseSqrt().array() *
       scale.row(0).transpose().array());
  EXPECT_NEAR(found.x[3], 1.0 / 1.2, 6.0 * sd[3]);
  EXPECT_NEAR(found.x[4], 1.02, 6.0 * sd[4]);
  EXPECT_LT(sd[3], 0.1);
  EXPECT_LT(sd[4], 0.01);
}

// A bound at B = 0 would put every second estimate on it.
TEST(JointLikelihoodOfAStringWithoutStiffness, ScattersAboutZero) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 0.08);
  constexpr int kDraws = 8;
  double sum = 0.0;
  int below = 0;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const NoisyRecords records = noisy(bowed, 0.02, seed);
    const CalibrationData data = CalibrationData::of_records(
        records.reactions[0], records.reactions[1], records.sample_rate);
    const JointLikelihood objective(
        {.left_noise = records.deviation[0], .right_noise = records.deviation[1]});
    const ParameterSet parameters(bowed.truth, Names{"f0", "B", "x_c"});
    const auto variables = parameters.variables();
    const auto function = objective.bind(data, parameters);
    const auto found = TinyLeastSquares({}).minimize(*function, variables, {});
    const double deviation = covariance_at(*function, variables, found.x).standard_deviation(1);
    EXPECT_GT(found.x[1], variables[1].lower + 4.0 * deviation);
    EXPECT_NEAR(found.x[1], 0.0, 4.0 * deviation) << seed;
    sum += found.x[1] / deviation;
    below += found.x[1] < 0.0;
  }
  // Mean of 8 standard normals, three of its deviations; all on one side once in 128 times.
  EXPECT_LT(std::abs(sum / kDraws), 3.0 / std::sqrt(kDraws));
  EXPECT_GT(below, 0);
  EXPECT_LT(below, kDraws);
}

TEST_F(JointLikelihoodTest, OthersRefuseWhatTheyCannotFind) {
  const ParameterSet gain(bowed.truth, Names{"x_c", "gain"});
  const ParameterSet damping(bowed.truth, Names{"x_c", "damping"});
  for (const std::string name : {"spectral_peak", "force_mismatch", "contact_location"}) {
    const auto other = Choice<Objective>(name).make();
    EXPECT_THROW(other->bind(data, gain), InvalidInput) << name;
    EXPECT_THROW(other->bind(data, damping), InvalidInput) << name;
  }
  const std::vector<std::string> names = {"f0", "B", "x_c", "damping", "gain"};
  const auto with_prior = [&](const char* first, const std::vector<std::string>& free) {
    WeightedSum::Options sum;
    sum.terms.resize(2);
    sum.terms[0].objective.select(first);
    sum.terms[1].objective.assign(Choice<Objective>::of<FrequencyPrior>(
        "frequency_prior", {.modes = {1}, .frequencies = {196.0}, .deviations = {1.0}}));
    return WeightedSum(sum).bind(data, ParameterSet(bowed.truth, free));
  };
  const auto sum = with_prior("joint_likelihood", names);
  std::vector<double> gradient(5);
  double value = 0.0;
  sum->evaluate(ParameterSet(bowed.truth, names).start(),
                {.value = &value, .gradient = gradient.data()});
  for (const double slope : gradient) EXPECT_NE(slope, 0.0);
  EXPECT_THROW(with_prior("spectral_peak", names), InvalidInput);
  EXPECT_NO_THROW(with_prior("spectral_peak", {"f_1", "x_c"}));
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
}  // namespace modcal::joint_likelihood_test
