#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libcalib/objectives/force_difference.hpp"
#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/parameters/parameter_options.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/calibration_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::force_mismatch_test {
namespace {

using Names = std::vector<std::string>;

constexpr double kRate = 6400.0;
constexpr std::size_t kSamples = 3200;

ForceMismatch mismatch_with(std::string_view regularizer, double parameter,
                            std::string weights = "uniform") {
  ForceMismatch::Options options;
  options.inversion.regularizer = Choice<Regularizer>(regularizer);
  options.inversion.parameter = parameter;
  options.weights = std::move(weights);
  return ForceMismatch(options);
}

TEST(ForceMismatch, IsHalfTheSquaredRelativeDifferenceOfTheForces) {
  const CalibrationData data = exact_data(paper_truth(12), kSamples, kRate, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(12), 0.01, 3);
  const ParameterSet parameters(initial, Names{"x_c"});
  const auto function = mismatch_with("water_level", 0.2).bind(data, parameters);
  double difference = 0.0, power = 0.0;
  const FrequencyGrid grid = data.grid();
  std::array<std::vector<Complex>, 2> transfer;
  for (std::size_t r = 0; r < 2; ++r) {
    transfer[r] = reaction_transfer(initial.basis, 0.03, static_cast<End>(r), grid);
  }
  for (std::size_t k = 1; k + 1 < grid.bins; ++k) {
    if (grid.omega(k) < 0.5 * initial.basis.omega[0]) continue;
    if (grid.omega(k) > 1.04 * initial.basis.omega[11]) continue;
    std::array<Complex, 2> force;
    if (std::abs(transfer[0][k]) <= 0.2 || std::abs(transfer[1][k]) <= 0.2) continue;
    for (std::size_t r = 0; r < 2; ++r) force[r] = data.reactions[r][k] / transfer[r][k];
    difference += std::norm(force[0] - force[1]);
    power += 0.5 * (std::norm(force[0]) + std::norm(force[1]));
  }
  const double expected = 0.5 * difference / power;
  EXPECT_NEAR(function->value(parameters.start()), expected, 1e-10 * expected);

  std::vector<double> residuals(function->residual_count());
  function->evaluate(parameters.start(), {.residuals = residuals.data()});
  double sum = 0.0;
  for (const double r : residuals) sum += 0.5 * r * r;
  EXPECT_NEAR(sum, expected, 1e-10 * expected);
}

TEST(ForceMismatch, JacobianAndGradientAreThoseOfTheResiduals) {
  const CalibrationData data = exact_data(paper_truth(12, 1e-4), kSamples, kRate, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(12, 1e-4), 0.01, 2);
  const ParameterSet parameters(initial, Names{"f_2", "f_7", "f0", "B", "x_c"});
  struct Case {
    std::string_view regularizer;
    double parameter;
    std::string weights;
  };
  // The water level that zeroes jumps where |H| crosses it; no bin does so within these steps.
  for (const auto& [regularizer, parameter, weights] :
       {Case{"tikhonov", 0.3, "uniform"}, Case{"tikhonov", 0.3, "transfer"},
        Case{"none", 0.0, "uniform"}, Case{"water_level", 0.2, "uniform"}}) {
    SCOPED_TRACE(regularizer);
    const auto function = mismatch_with(regularizer, parameter, weights).bind(data, parameters);
    // See spectral_peak_test for the error of differences over 1e-5 scales.
    expect_slopes_match(*function, parameters.variables(), parameters.start(), 1e-5, 3e-5);
  }
}

TEST(ForceMismatch, LeastSquaresRecoverTheModelFromExactData) {
  const ModelPoint truth = paper_truth(12, 1e-4, 0.0285);
  const CalibrationData data = exact_data(truth, kSamples, kRate, 196.0);
  // Off by less than the width of a resonance, where the objective has one minimum.
  ModelPoint initial = with_frequency_errors(truth, 5e-4, 4);
  initial.contact = 0.0287;
  Names names = ParameterOptions{.frequencies = "all", .contact = true}.names(12);
  const ParameterSet parameters(initial, names);
  for (const auto& [regularizer, level] : {std::pair("tikhonov", 0.1), std::pair("none", 0.0)}) {
    const auto function = mismatch_with(regularizer, level).bind(data, parameters);
    const auto result =
        CeresOptimizer(CeresOptimizer::Options{}).minimize(*function, parameters.variables(), {});
    const ModelPoint found = parameters.model(result.x);
    // Both forces are filtered alike: the residual of the truth is zero, and Gauss–Newton converges
    // quadratically to rounding.
    EXPECT_LT(result.value, 1e-15 * result.initial_value) << regularizer;
    EXPECT_NEAR(found.contact, truth.contact, 1e-9) << regularizer;
    for (std::size_t n = 0; n < 12; ++n) {
      EXPECT_NEAR(found.basis.omega[n], truth.basis.omega[n], 1e-7 * truth.basis.omega[n]) << n;
    }
  }
}

TEST(ForceMismatch, TheLawAndTheContactAreRecoveredTogether) {
  const ModelPoint truth = paper_truth(12, 1e-4, 0.0285);
  const CalibrationData data = exact_data(truth, kSamples, kRate, 196.0);
  ModelPoint initial = truth;
  initial.contact = 0.02855;
  for (double& omega : initial.basis.omega) omega *= 1.0002;
  const ParameterSet parameters(initial, Names{"f0", "B", "x_c"});
  const auto function = mismatch_with("tikhonov", 0.1).bind(data, parameters);
  const auto result =
      CeresOptimizer(CeresOptimizer::Options{}).minimize(*function, parameters.variables(), {});
  EXPECT_NEAR(result.x[0], 196.0, 196.0 * 1e-8);
  EXPECT_NEAR(result.x[1], 1e-4, 1e-10);
  EXPECT_NEAR(result.x[2], 0.0285, 1e-10);
}

TEST(ForceMismatch, RefusesOneReactionAndEmptyBands) {
  CalibrationData data = exact_data(paper_truth(12), kSamples, kRate, 196.0);
  const ParameterSet parameters(paper_truth(12), Names{"x_c"});
  ForceMismatch::Options options;
  options.inversion.lowest = 500.5;
  options.inversion.highest = 501.5;
  EXPECT_THROW(ForceMismatch(options).bind(data, parameters), InvalidInput);
  // Everything is below the water level.
  EXPECT_THROW(mismatch_with("water_level", 1e9).bind(data, parameters), InvalidInput);
  EXPECT_THROW(mismatch_with("tikhonov", -1.0).bind(data, parameters), InvalidInput);
  EXPECT_THROW(mismatch_with("tikhonov", 1.0, "heavy"), InvalidInput);
  data.reactions[1].clear();
  try {
    mismatch_with("tikhonov", 0.1).bind(data, parameters);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("the right reaction is missing"));
  }
}

}  // namespace
}  // namespace modcal::force_mismatch_test
