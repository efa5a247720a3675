#include "libinverse/regularizer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libinverse/spectral/regularizers/filter_terms.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::regularizer_test {
namespace {

std::shared_ptr<const Regularizer> make(std::string_view name) {
  return Choice<Regularizer>(name).make();
}

std::vector<double> factors_of(std::string_view name, const std::vector<double>& sigma,
                               double parameter) {
  std::vector<double> factors(sigma.size());
  make(name)->filter_factors(sigma, parameter, factors);
  return factors;
}

const std::vector<double> kSigma = {2.0, 0.5, 1.0, 0.0, 0.25};

TEST(FilterFactors, OfTheWaterLevelThatZeroes) {
  EXPECT_EQ(factors_of("water_level", kSigma, 0.5), (std::vector<double>{1, 0, 1, 0, 0}));
  EXPECT_EQ(factors_of("water_level", kSigma, 0.0), (std::vector<double>{1, 1, 1, 0, 1}));
}

TEST(FilterFactors, OfTheWaterLevelThatClips) {
  EXPECT_EQ(factors_of("water_level_clip", kSigma, 1.0), (std::vector<double>{1, 0.5, 1, 0, 0.25}));
  EXPECT_EQ(factors_of("water_level_clip", kSigma, 0.0), (std::vector<double>{1, 1, 1, 0, 1}));
}

TEST(FilterFactors, OfTikhonov) {
  EXPECT_EQ(factors_of("tikhonov", kSigma, 0.5),
            (std::vector<double>{16.0 / 17.0, 0.5, 0.8, 0, 0.2}));
  EXPECT_EQ(factors_of("tikhonov", kSigma, 0.0), (std::vector<double>{1, 1, 1, 0, 1}));
}

TEST(FilterFactors, OfDirectInversion) {
  EXPECT_EQ(factors_of("none", kSigma, 0.0), (std::vector<double>{1, 1, 1, 0, 1}));
  EXPECT_FALSE(make("none")->has_parameter());
}

// A problem with many components over nine decades, some of σ = 0, in no order.
struct RandomProblem {
  explicit RandomProblem(std::size_t size) {
    std::vector<double> draw(3 * size);
    fill_standard_normal(StreamKey(4).with(std::uint64_t{size}), draw);
    std::vector<double> sigma(size), multiplicity(size), weight(size);
    power.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      sigma[i] = i % 97 == 5 ? 0.0 : std::exp(3.0 * draw[3 * i]);
      multiplicity[i] = i % 7 == 0 ? 1.0 : 2.0;
      weight[i] = std::exp(draw[3 * i + 1]);
      power[i] = std::exp(2.0 * draw[3 * i + 2]);
    }
    problem = SpectralOperator(sigma, multiplicity, weight, 2 * size);
  }
  SpectralSystem system(Measure measure) const {
    return {{.problem = &problem, .power = power, .outside_power = 0.125}, measure};
  }
  SpectralOperator problem{{}, {}, {}, 0};
  std::vector<double> power;  // sorted order
};

std::vector<double> parameters_of(const RandomProblem& random) {
  std::vector<double> parameters = {0.0};
  double p = 1e-6;
  while (p < 1e6) {
    parameters.push_back(p);
    p *= 1.7;
  }
  parameters.push_back(random.problem.sigma()[7]);  // exactly a singular value
  parameters.push_back(random.problem.sigma()[0]);
  std::sort(parameters.begin(), parameters.end());
  return parameters;
}

class EveryRegularizer : public testing::TestWithParam<std::string> {};

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const auto& entry : Regularizer::registry()) result.emplace_back(entry.name);
  return result;
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryRegularizer, testing::ValuesIn(names()));

TEST_P(EveryRegularizer, TracesTheCurveThatOneSumPerParameterGives) {
  const RandomProblem random(3000);
  const auto regularizer = make(GetParam());
  const std::vector<double> parameters = parameters_of(random);
  for (const Measure measure : {Measure::kSolution, Measure::kDerivative}) {
    const SpectralSystem system = random.system(measure);
    std::vector<CurvePoint> curve(parameters.size());
    regularizer->trace(system, parameters, curve);
    std::vector<double> kept(system.size());
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      regularizer->filter_factors(penalized_sigma(*regularizer, random.problem), parameters[j],
                                  kept);
      double residual = 0.125, solution = 0.0, freedom = 0.0;
      for (std::size_t i = 0; i < system.size(); ++i) {
        residual += (1.0 - kept[i]) * (1.0 - kept[i]) * system.power[i];
        solution += kept[i] * kept[i] * system.solution_weight[i] * system.power[i];
        freedom += kept[i] * system.multiplicity[i];
      }
      // Sums of 3000 positive terms round to below 3000 · 1.1e-16; the compacted sums keep 1e-11.
      const double tolerance = GetParam() == "tikhonov" || GetParam() == "wiener" ? 2e-11 : 7e-13;
      EXPECT_EQ(curve[j].parameter, parameters[j]);
      EXPECT_NEAR(curve[j].residual_norm, std::sqrt(residual), tolerance * std::sqrt(residual));
      EXPECT_NEAR(curve[j].solution_norm, std::sqrt(solution), tolerance * std::sqrt(solution));
      EXPECT_NEAR(curve[j].freedom, freedom, tolerance * freedom);
    }
  }
}

TEST_P(EveryRegularizer, FactorsLieBetweenZeroAndOneAndComplementEachOther) {
  const RandomProblem random(500);
  const auto regularizer = make(GetParam());
  const std::span<const double> sigma = random.problem.sigma();
  std::vector<double> kept(sigma.size()), lost(sigma.size());
  for (const double parameter : {0.0, 1e-300, 1e-3, 1.0, 1e3, 1e300}) {
    regularizer->filter_factors(sigma, parameter, kept, lost);
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      EXPECT_GE(kept[i], 0.0);
      EXPECT_LE(kept[i], i == 0 ? 1.0 : kept[i - 1]);  // rises with σ
      EXPECT_NEAR(kept[i] + lost[i], 1.0, 3e-16);
    }
  }
}

TEST_P(EveryRegularizer, ResidualRisesAndSolutionFallsWithTheParameter) {
  const RandomProblem random(3000);
  const std::vector<double> parameters = parameters_of(random);
  std::vector<CurvePoint> curve(parameters.size());
  make(GetParam())->trace(random.system(Measure::kDerivative), parameters, curve);
  for (std::size_t j = 1; j < curve.size(); ++j) {
    // Flat ends may round either way.
    EXPECT_GE(curve[j].residual_norm, curve[j - 1].residual_norm * (1.0 - 1e-11));
    EXPECT_LE(curve[j].solution_norm, curve[j - 1].solution_norm * (1.0 + 1e-11));
    EXPECT_LE(curve[j].freedom, curve[j - 1].freedom * (1.0 + 1e-11));
  }
}

TEST_P(EveryRegularizer, RefusesBadParameters) {
  const RandomProblem random(10);
  const auto regularizer = make(GetParam());
  std::vector<CurvePoint> curve(2);
  const SpectralSystem system = random.system(Measure::kSolution);
  EXPECT_THROW(regularizer->trace(system, std::vector{2.0, 1.0}, curve), InvalidInput);
  EXPECT_THROW(regularizer->trace(system, std::vector{-1.0, 1.0}, curve), InvalidInput);
  EXPECT_THROW(regularizer->trace(system, std::vector{1.0, std::nan("")}, curve), InvalidInput);
}

TEST(CompactedTerms, AreFarFewerThanTheComponents) {
  const RandomProblem random(30000);
  const SpectralSystem system = random.system(Measure::kSolution);
  // Ten decades in bands of a factor 1.5: below 60 bands of 12 nodes.
  EXPECT_LT(compacted_terms_of(system).sigma.size(), 720u);
}

TEST(Tikhonov, KeepsTheDigitsOfASmallResidual) {
  // λ/σ = 1e-12: 1 − φ is 1e-24, which 1 − φ in floating point would give as 0.
  const SpectralOperator problem({1.0}, {1.0}, {}, 1);
  const std::vector<double> power = {1.0};
  CurvePoint point;
  Tikhonov(Tikhonov::Options{})
      .trace({{.problem = &problem, .power = power}, Measure::kSolution}, std::vector{1e-12},
             std::span(&point, 1));
  EXPECT_NEAR(point.residual_norm, 1e-24, 1e-39);
}

// Whoever compares a solution with normal equations takes the penalty from the regularizer: here it
// is a number of its own. One product and one root round to 1 ulp each.
TEST(Penalty, OfTheWienerFilterIsFlatBelowItsCornerAndRisesAsTheFrequencyAbove) {
  const double corner = 80.0, reference = 3.0;  // the latter must not matter
  const WienerFilter filter({.corner = corner});
  for (const auto& [ratio, expected] :
       {std::pair{0.0, 1.0}, {1.0, std::numbers::sqrt2}, {0.75, 1.25}, {2.4, 2.6}, {1e9, 1e9}}) {
    const double omega = 2.0 * std::numbers::pi * corner * ratio;
    EXPECT_NEAR(filter.penalty(omega, reference), expected, 4.5e-16 * expected) << ratio;
  }
}

TEST(Penalty, OfTikhonovIsThePowerOfTheFrequencyThatItsOrderSays) {
  for (const auto& [order, expected] : {std::pair<int, double>{0, 1.0}, {1, 2.5}, {2, 6.25}}) {
    EXPECT_EQ(Tikhonov({.order = order}).penalty(10.0, 4.0), expected) << order;
  }
}

TEST(SpectralOperator, SortsAndRemembersTheOrder) {
  const SpectralOperator problem(kSigma, {1, 2, 3, 4, 5}, {1, 1, 4, 1, 1}, 9);
  EXPECT_EQ(std::vector<double>(problem.sigma().begin(), problem.sigma().end()),
            (std::vector<double>{2, 1, 0.5, 0.25, 0}));
  EXPECT_EQ(std::vector<std::uint32_t>(problem.order().begin(), problem.order().end()),
            (std::vector<std::uint32_t>{0, 2, 1, 4, 3}));
  const auto weight = problem.solution_weight(Measure::kDerivative);
  EXPECT_EQ(std::vector<double>(weight.begin(), weight.end()),
            (std::vector<double>{0.25, 4, 4, 16, 0}));
  EXPECT_EQ(problem.zeros(), 1u);
  EXPECT_EQ(problem.freedom(), 15.0);
}

TEST(SpectralOperator, RefusesWhatIsNoSingularValue) {
  EXPECT_THROW(SpectralOperator({1.0, -1.0}, {1, 1}, {}, 2), InvalidInput);
  EXPECT_THROW(SpectralOperator({1.0, std::nan("")}, {1, 1}, {}, 2), InvalidInput);
  EXPECT_THROW(SpectralOperator({1.0, 2.0}, {1}, {}, 2), InvalidInput);
}

}  // namespace
}  // namespace modcal::regularizer_test
