#include "libinverse/parameter_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/problem/spectral_system.hpp"
#include "libsim/base/error.hpp"

namespace modcal::parameter_choice_test {
namespace {

using testing::HasSubstr;

std::shared_ptr<const Regularizer> regularizer(std::string_view name) {
  return Choice<Regularizer>(name).make();
}

// Components of one degree of freedom each, σ falling, derivative weight 4, one datum outside.
struct Problem {
  Problem(const std::vector<double>& sigma, std::vector<double> power_given, double outside)
      : problem(sigma, std::vector(sigma.size(), 1.0), std::vector(sigma.size(), 4.0),
                sigma.size() + 1),
        power(std::move(power_given)),
        data{.problem = &problem, .power = power, .outside_power = outside} {}
  SpectralOperator problem;
  std::vector<double> power;
  SpectralData data;
};

// Water level ε       ‖r‖²               ‖x‖²                product²
//   below 0.001       1                  1e4 + 1e3 + 1e6     1.011e6
//   [0.001, 1)        1 + 1              1e4 + 1e3           2.2e4     <- interior minimum
//   [1, 100)          1 + 1 + 1e3        1e4                 1.002e7
//   100               1 + 1 + 1e3 + 1e8  0                   0
const Problem& basin() {
  static const Problem problem({100.0, 1.0, 0.001}, {1e8, 1e3, 1.0}, 1.0);
  return problem;
}

// A signal above the noise in 60 components whose σ falls by a factor 1.3 each: |b|² = s² σ^2.6
// + 1.
const Problem& noisy_decay() {
  static const Problem problem = [] {
    std::vector<double> sigma, power;
    for (int i = 0; i < 60; ++i) {
      sigma.push_back(1e4 * std::pow(1.3, -i));
      power.push_back(std::pow(sigma.back(), 2.6) + 1.0);
    }
    return Problem(sigma, power, 1.0);
  }();
  return problem;
}

TEST(MinimalProduct, FindsTheInteriorMinimum) {
  const MinimalProduct rule({.curve = {.points = 601, .lowest = 1e-4, .measure = "solution"}});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  EXPECT_GE(chosen.parameter(), 0.001);
  EXPECT_LT(chosen.parameter(), 1.0);
  EXPECT_NEAR(chosen.point.criterion, std::sqrt(2.2e4), 1e-10);
  EXPECT_NEAR(chosen.point.residual_norm, std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(chosen.point.solution_norm, std::sqrt(1.1e4), 1e-11);
  EXPECT_NEAR(chosen.kept_share, 2.0 / 3.0, 1e-15);
  EXPECT_THAT(chosen.explanation, HasSubstr("1 interior local minima"));
  ASSERT_EQ(chosen.curve.size(), 601u);
  EXPECT_NEAR(chosen.curve.front().criterion, std::sqrt(1.011e6), 1e-9);
  EXPECT_EQ(chosen.curve.back().criterion, 0.0);
}

TEST(MinimalProduct, WeighsTheDerivativeUnlessToldOtherwise) {
  const MinimalProduct rule({.curve = {.lowest = 1e-4}});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  EXPECT_NEAR(chosen.point.solution_norm, std::sqrt(4.0 * 1.1e4), 1e-11);
}

TEST(MinimalProduct, SaysSoWhenThereIsNoInteriorMinimum) {
  // From [1, 100) on the product only falls.
  const MinimalProduct rule({.curve = {.lowest = 2.0}});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kNoInteriorMinimum);
  EXPECT_EQ(chosen.parameter(), 2.0);
  EXPECT_THAT(chosen.explanation, HasSubstr("no local minimum"));
}

TEST(GeneralizedCrossValidation, IsTheQuotientWorkedByHand) {
  const GeneralizedCrossValidation rule({.curve = {.points = 601, .lowest = 1e-4}});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  // 1/(4−3)², 2/(4−2)², 1002/(4−1)²: smallest in [0.001, 1).
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  EXPECT_NEAR(chosen.point.criterion, 0.5, 1e-15);
  EXPECT_NEAR(chosen.curve.front().criterion, 1.0, 1e-15);
  EXPECT_GE(chosen.parameter(), 0.001);
  EXPECT_LT(chosen.parameter(), 1.0);
}

TEST(GeneralizedCrossValidation, SaysSoAtTheEdge) {
  const GeneralizedCrossValidation rule({.curve = {.lowest = 1e-2}});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kEdgeOfRange);
  EXPECT_EQ(chosen.parameter(), 1e-2);
}

TEST(PredictiveRisk, IsTheSumWorkedByHand) {
  const PredictiveRisk rule({.curve = {.points = 601, .lowest = 1e-4}, .noise_rms = 1.0});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  // 1 + 2·3 − 4 = 3, 2 + 2·2 − 4 = 2, 1002 + 2 − 4 = 1000.
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  EXPECT_NEAR(chosen.point.criterion, 2.0, 1e-14);
  EXPECT_NEAR(chosen.curve.front().criterion, 3.0, 1e-14);
}

TEST(Discrepancy, TakesTheLargestParameterWithinTheNoise) {
  // Norm of the noise √4 · 0.8 = 1.6 lies between √2 and √1002: everything below ε = 1 is within.
  const Discrepancy rule({.curve = {.points = 601, .lowest = 1e-4}, .noise_rms = 0.8});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  EXPECT_LT(chosen.parameter(), 1.0);
  EXPECT_GT(chosen.parameter(), 0.97);  // one step of the grid: a factor 10^(1/100)
  EXPECT_NEAR(chosen.point.criterion, std::sqrt(2.0) / 1.6, 1e-14);
}

TEST(Discrepancy, TakesTheNoiseFromTheDataUnlessItIsGiven) {
  SpectralData data = basin().data;
  const Discrepancy rule({.curve = {.lowest = 1e-4}});
  EXPECT_THROW(rule.choose(*regularizer("water_level"), data), InvalidInput);
  data.noise_rms = 0.8;
  EXPECT_EQ(rule.choose(*regularizer("water_level"), data).status, ChoiceStatus::kChosen);
}

TEST(Discrepancy, SaysSoBeyondEitherEnd) {
  const auto level = regularizer("water_level");
  const Discrepancy low({.curve = {.lowest = 1e-4}, .noise_rms = 0.4});  // 0.8 < √1
  EXPECT_EQ(low.choose(*level, basin().data).status, ChoiceStatus::kNotReached);
  EXPECT_EQ(low.choose(*level, basin().data).parameter(), 1e-4);
  const Discrepancy high({.curve = {.lowest = 1e-4}, .noise_rms = 1e5});
  EXPECT_EQ(high.choose(*level, basin().data).status, ChoiceStatus::kEdgeOfRange);
  EXPECT_EQ(high.choose(*level, basin().data).parameter(), 100.0);
}

TEST(LCurve, FindsTheCornerOfAnL) {
  // The signal s² σ^2.6 meets the noise at σ = 1: the corner lies within a decade of it.
  for (const char* name : {"tikhonov", "water_level", "water_level_clip"}) {
    const LCurve rule({.curve = {.lowest = 1e-3, .measure = "solution"}, .span = 0.2});
    const ChosenParameter chosen = rule.choose(*regularizer(name), noisy_decay().data);
    EXPECT_EQ(chosen.status, ChoiceStatus::kChosen) << name;
    EXPECT_GT(chosen.parameter(), 0.1) << name;
    EXPECT_LT(chosen.parameter(), 10.0) << name;
    EXPECT_GT(chosen.point.criterion, 0.0) << name;
  }
}

TEST(LCurve, SaysSoWithoutACorner) {
  // Noise alone with σ in [1, 1 + 1e-6]: one step, and nothing turns on either side of it.
  const Problem flat({1.0, 1.0}, {1.0, 1.0}, 1.0);
  const LCurve rule({.curve = {.lowest = 2.0, .highest = 100.0, .measure = "solution"}});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), flat.data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kNotReached);
}

TEST(GivenParameter, IsTakenAsItIsBesideTheCurve) {
  const GivenParameter rule({.value = 0.5});
  const ChosenParameter chosen = rule.choose(*regularizer("water_level"), basin().data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kGiven);
  EXPECT_EQ(chosen.parameter(), 0.5);
  EXPECT_NEAR(chosen.point.residual_norm, std::sqrt(2.0), 1e-14);
  EXPECT_EQ(chosen.curve.size(), 400u);
  const GivenParameter bare({.value = 0.5, .curve = {.points = 0}});
  EXPECT_TRUE(bare.choose(*regularizer("water_level"), basin().data).curve.empty());
}

class EveryChoice : public testing::TestWithParam<std::string> {
 protected:
  static std::shared_ptr<const ParameterChoice> rule() {
    if (GetParam() == "fixed") {
      return std::make_shared<GivenParameter>(GivenParameter::Options{.value = 0.3});
    }
    return Choice<ParameterChoice>(GetParam()).make();
  }
};

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const auto& entry : ParameterChoice::registry()) result.emplace_back(entry.name);
  return result;
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryChoice, testing::ValuesIn(names()));

TEST_P(EveryChoice, ReturnsItsWholeCurveAndAStatus) {
  SpectralData data = noisy_decay().data;
  data.noise_rms = 1.0;
  for (const auto& entry : Regularizer::registry()) {
    const auto plugin = regularizer(entry.name);
    const ChosenParameter chosen = rule()->choose(*plugin, data);
    EXPECT_NE(chosen.status, ChoiceStatus::kNotComputed) << entry.name;
    EXPECT_FALSE(chosen.explanation.empty());
    EXPECT_GE(chosen.kept_share, 0.0);
    EXPECT_LE(chosen.kept_share, 1.0 + 1e-11);
    if (!plugin->has_parameter()) {
      EXPECT_EQ(chosen.status, ChoiceStatus::kNoParameter);
      continue;
    }
    ASSERT_EQ(chosen.curve.size(), 400u);
    for (std::size_t j = 1; j < chosen.curve.size(); ++j) {
      EXPECT_GT(chosen.curve[j].parameter, chosen.curve[j - 1].parameter);
    }
    const double largest = falling_penalized_sigma(*plugin, *data.problem)[0];
    EXPECT_EQ(chosen.curve.back().parameter, largest);
    EXPECT_TRUE(plugin->has_penalty() || largest == 1e4);
    if (!warning_of(chosen).empty()) {
      EXPECT_THAT(chosen.warnings, testing::Contains(chosen.explanation));
    }
  }
}

TEST_P(EveryChoice, TellsWhenTheDataHoldNothing) {
  Problem blind({0.0, 0.0}, {1.0, 1.0}, 0.0);
  blind.data.noise_rms = 1.0;
  const ChosenParameter chosen = rule()->choose(*regularizer("water_level"), blind.data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kNoParameter);
  EXPECT_EQ(chosen.point.solution_norm, 0.0);
  EXPECT_NEAR(chosen.point.residual_norm, std::sqrt(2.0), 1e-15);
  EXPECT_THAT(chosen.explanation, HasSubstr("every singular value is 0"));
}

TEST_P(EveryChoice, TakesAllZeroDataAndASingleComponent) {
  Problem silent({3.0, 2.0, 1.0}, {0.0, 0.0, 0.0}, 0.0);
  silent.data.noise_rms = 0.0;
  EXPECT_NE(rule()->choose(*regularizer("water_level"), silent.data).status,
            ChoiceStatus::kNotComputed);
  Problem single({3.0}, {1.0}, 0.0);
  single.data.noise_rms = 0.1;
  const ChosenParameter chosen = rule()->choose(*regularizer("tikhonov"), single.data);
  EXPECT_EQ(chosen.curve.size(), 1u);
  EXPECT_NE(chosen.status, ChoiceStatus::kNotComputed);
}

TEST(CurveOptions, RefuseARangeThatIsNone) {
  EXPECT_THROW(MinimalProduct({.curve = {.points = 2}}), InvalidInput);
  EXPECT_THROW(MinimalProduct({.curve = {.lowest = 0.0}}), InvalidInput);
  EXPECT_THROW(MinimalProduct({.curve = {.measure = "length"}}), InvalidInput);
  EXPECT_THROW(GivenParameter({.value = -1.0}), InvalidInput);
  EXPECT_THROW(GivenParameter{GivenParameter::Options{}}, InvalidInput);
  EXPECT_THROW(Discrepancy({.tau = 0.5}), InvalidInput);
  EXPECT_THROW(Discrepancy({.noise_rms = -1.0}), InvalidInput);
  EXPECT_THROW(LCurve({.span = -1.0}), InvalidInput);
  const MinimalProduct empty({.curve = {.lowest = 1e3, .highest = 1e2}});
  EXPECT_THROW(empty.choose(*regularizer("water_level"), basin().data), InvalidInput);
}

}  // namespace
}  // namespace modcal::parameter_choice_test
