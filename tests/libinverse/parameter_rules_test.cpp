// Rules on problems whose answer is known in closed form.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "benchmarks/problems/ill_posed_problems.hpp"
#include "benchmarks/problems/svd_problem.hpp"
#include "libinverse/parameter_choice.hpp"
#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::parameter_rules_test {
namespace {

const Tikhonov kTikhonov{Tikhonov::Options{}};
const TruncatedSvd kTruncated{TruncatedSvd::Options{}};

// 5 components of singular value 2 and 15 data outside their range: with Tikhonov every rule sees
// the lost share l = λ²/(σ² + λ²) alone, ‖r‖² = l² B + O, ‖x‖² = (1 − l)² B/σ², 5 (1 − l) degrees
// of freedom of 20 data.
struct OneValueProblem {
  static constexpr double kSigma = 2.0, kInside = 100.0, kOutside = 6.0, kCount = 5.0, kRows = 20.0;
  SpectralOperator problem{std::vector<double>(5, kSigma), std::vector<double>(5, 1.0), {}, 20};
  std::vector<double> power = std::vector<double>(5, kInside / kCount);

  ChosenParameter choose(const ParameterChoice& rule) const {
    SpectralData data;
    data.problem = &problem;
    data.power = power;
    data.outside_power = kOutside;
    data.noise_rms = 0.7;
    return rule.choose(kTikhonov, data);
  }
  static double lost(const ChosenParameter& choice) {
    const double ratio = kSigma / choice.parameter();
    return 1.0 / (1.0 + ratio * ratio);
  }
};

// λ from 1e-3 to 20 in 8000 steps of 0.12 %; l moves by twice that.
CurveOptions fine_curve() {
  return {.points = 8000, .lowest = 1e-3, .highest = 20.0, .measure = "solution"};
}
constexpr double kStep = 0.0025;

template <typename Criterion>
double minimum_over_lost(Criterion criterion) {
  double best = 1e-6, l = 1e-6;
  while (l < 1.0) {
    if (criterion(l) < criterion(best)) best = l;
    l *= 1.0005;
  }
  return best;
}

TEST(ClosedForm, CrossValidationAndEvidence) {
  // d/dl of (l² B + O)/(m − n + n l)² and of m log(l B + O) − n log l both vanish at
  // l = n O/((m − n) B).
  using P = OneValueProblem;
  const double expected = P::kCount * P::kOutside / ((P::kRows - P::kCount) * P::kInside);
  const auto gcv = P().choose(GeneralizedCrossValidation({.curve = fine_curve()}));
  const auto evidence = P().choose(Evidence({.curve = fine_curve()}));
  EXPECT_EQ(gcv.status, ChoiceStatus::kChosen);
  EXPECT_EQ(evidence.status, ChoiceStatus::kChosen);
  EXPECT_NEAR(P::lost(gcv) / expected, 1.0, kStep);
  EXPECT_NEAR(P::lost(evidence) / expected, 1.0, kStep);
}

TEST(ClosedForm, PredictiveRiskAndDiscrepancy) {
  using P = OneValueProblem;
  const double noise = 0.7;
  const auto risk = P().choose(PredictiveRisk({.curve = fine_curve()}));
  EXPECT_NEAR(P::lost(risk) / (P::kCount * noise * noise / P::kInside), 1.0, kStep);
  const auto discrepancy = P().choose(Discrepancy({.curve = fine_curve(), .tau = 1.1}));
  const double bound = 1.1 * 1.1 * noise * noise * P::kRows;
  EXPECT_NEAR(P::lost(discrepancy) / std::sqrt((bound - P::kOutside) / P::kInside), 1.0, kStep);
}

TEST(ClosedForm, MinimalProduct) {
  // (l² B + O)(1 − l)² falls from l = 0 to the smaller root of 2 B l² − B l + O = 0.
  using P = OneValueProblem;
  const auto chosen = P().choose(MinimalProduct({.curve = fine_curve()}));
  const double root = std::sqrt(P::kInside * P::kInside - 8.0 * P::kInside * P::kOutside);
  const double expected = (P::kInside - root) / (4.0 * P::kInside);
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  // A flat minimum: the criterion is the same to rounding over 1e-8, the grid is coarser.
  EXPECT_NEAR(P::lost(chosen) / expected, 1.0, kStep);
}

TEST(ClosedForm, CurvatureOfTheLCurve) {
  // With l_i = λ²/(σ_i² + λ²) and t = log λ, dl/dt = 2 l (1 − l) gives both norms' derivatives.
  const std::vector<double> sigma = {1.0, 0.01}, power = {100.0, 0.1};
  const auto curvature = [&](double t) {
    double r[3] = {0.0, 0.0, 0.0}, x[3] = {0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < 2; ++i) {
      const double l = 1.0 / (1.0 + std::pow(sigma[i] / std::exp(t), 2)), kept = 1.0 - l;
      const double weight = power[i] / (sigma[i] * sigma[i]);
      r[0] += l * l * power[i];
      r[1] += 4.0 * l * l * kept * power[i];
      r[2] += 8.0 * l * l * kept * (2.0 - 3.0 * l) * power[i];
      x[0] += kept * kept * weight;
      x[1] -= 4.0 * l * kept * kept * weight;
      x[2] -= 8.0 * l * kept * kept * (1.0 - 3.0 * l) * weight;
    }
    const double r1 = 0.5 * r[1] / r[0], r2 = 0.5 * (r[2] / r[0] - r[1] * r[1] / (r[0] * r[0]));
    const double x1 = 0.5 * x[1] / x[0], x2 = 0.5 * (x[2] / x[0] - x[1] * x[1] / (x[0] * x[0]));
    return (r1 * x2 - r2 * x1) / std::pow(r1 * r1 + x1 * x1, 1.5);
  };
  const double low = std::log(1e-3), high = 0.0;
  double expected = low, t = low;
  while (t < high) {
    if (curvature(t) > curvature(expected)) expected = t;
    t += 1e-3;
  }
  const SpectralOperator problem(sigma, {1.0, 1.0}, {}, 2);
  SpectralData data;
  data.problem = &problem;
  data.power = power;
  const LCurve rule(
      {.curve = {.points = 2000, .lowest = 1e-3, .highest = 1.0, .measure = "solution"},
       .span = 0.0});
  const auto chosen = rule.choose(kTikhonov, data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  // The grid's step of 0.0035 and the scan's of 0.001; differences over two steps h = 0.0035 err by
  // h²/6 of the third derivative, about 1e-5.
  EXPECT_NEAR(std::log(chosen.parameter()), expected, 0.005);
  EXPECT_NEAR(chosen.point.criterion, curvature(expected), 1e-3 * curvature(expected));
}

TEST(ClosedForm, RobustCrossValidation) {
  using P = OneValueProblem;
  for (const double gamma : {0.1, 0.3, 1.0}) {
    const double expected = minimum_over_lost([gamma](double l) {
      const double kept = 1.0 - l, left = P::kRows - P::kCount * kept;
      return (gamma + (1.0 - gamma) * P::kCount * kept * kept / P::kRows) *
             (l * l * P::kInside + P::kOutside) / (left * left);
    });
    const auto chosen = P().choose(RobustCrossValidation({.curve = fine_curve(), .gamma = gamma}));
    EXPECT_NEAR(P::lost(chosen) / expected, 1.0, 2.0 * kStep) << gamma;
  }
  EXPECT_THROW(RobustCrossValidation({.gamma = 0.0}), InvalidInput);
}

TEST(ClosedForm, QuasiOptimality) {
  // |dφ/d log λ| = 2 φ (1 − φ) peaks at λ = σ. Two components of equal weight in ‖x‖ are symmetric
  // about the geometric mean of their σ, where both stand still.
  const SpectralOperator problem({1e3, 1e-3}, {1.0, 1.0}, {}, 2);
  const std::vector<double> power = {1e6, 1e-6};
  SpectralData data;
  data.problem = &problem;
  data.power = power;
  const QuasiOptimality rule({.curve = {.points = 2001, .measure = "solution"}});
  const auto chosen = rule.choose(kTikhonov, data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  // One of 2000 steps over 6 decades, 0.7 %, differences lying between two points.
  EXPECT_NEAR(chosen.parameter(), 1.0, 0.014);
}

// Singular values 8 … 1 and coefficients of two strong components and six of noise.
ChosenParameter choose_truncation(const ParameterChoice& rule, std::vector<double> power) {
  const SpectralOperator problem({8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0},
                                 std::vector<double>(8, 1.0), {}, 8);
  SpectralData data;
  data.problem = &problem;
  data.power = power;
  return rule.choose(kTruncated, data);
}
const CurveOptions kSteps = {.points = 1000, .lowest = 0.5, .highest = 8.5, .measure = "solution"};

TEST(ClosedForm, CumulativePeriodogramKeepsWhatIsNotWhite) {
  // Residual 0 0 1 1 1 1 1 1 after two: 0.25 from the line, 0.375 after three, 0.64 after one.
  const auto chosen = choose_truncation(CumulativePeriodogram({.curve = kSteps}),
                                        {100.0, 50.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen);
  EXPECT_EQ(chosen.point.freedom, 2.0);
  EXPECT_NEAR(chosen.point.criterion, 0.25, 1e-15);
}

TEST(ClosedForm, CrossValidationOfATruncation) {
  // ‖r‖²/(8 − k)²: 156/64, 56/49, 6/36, 5/25, 4/16, …: k = 2.
  const auto chosen = choose_truncation(GeneralizedCrossValidation({.curve = kSteps}),
                                        {100.0, 50.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
  EXPECT_EQ(chosen.point.freedom, 2.0);
  EXPECT_NEAR(chosen.point.criterion, 6.0 / 36.0, 1e-15);
}

TEST(ClosedForm, EvidenceOfATruncationIsWorthOneDatum) {
  // 8 log(‖r‖² + ‖kept‖²/9) + k log 9 by hand for k = 0 … 7.
  const std::vector<double> power = {100.0, 50.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  const auto chosen = choose_truncation(Evidence({.curve = kSteps}), power);
  std::size_t best = 0;
  double least = 1e300;
  for (std::size_t k = 0; k <= 8; ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 8; ++i) sum += power[i] * (i < k ? 1.0 / 9.0 : 1.0);
    const double criterion = 8.0 * std::log(sum) + static_cast<double>(k) * std::log(9.0);
    if (criterion < least) {
      least = criterion;
      best = k;
    }
  }
  EXPECT_EQ(chosen.point.freedom, static_cast<double>(best));
  EXPECT_NEAR(chosen.point.criterion, least, 1e-12 * least);
  EXPECT_EQ(best, 2u);
}

TEST(ClosedForm, AdaptiveCornerOfAnL) {
  // Coefficients of x are 1 up to i = 5 and noise of 3e-6 over σ = 10^−i behind it: keeping 0 … 5
  // takes the residual down to the noise, and every further one multiplies ‖x‖ while the residual
  // hardly falls.
  std::vector<double> sigma, power;
  for (int i = 0; i < 14; ++i) {
    sigma.push_back(std::pow(10.0, -i));
    power.push_back(i < 6 ? std::pow(10.0, -2.0 * i) : 9e-12);
  }
  const SpectralOperator problem(sigma, std::vector<double>(14, 1.0), {}, 14);
  SpectralData data;
  data.problem = &problem;
  data.power = power;
  const LCurveAdaptive rule({.curve = {.points = 300, .measure = "solution"}});
  const auto chosen = rule.choose(kTruncated, data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kChosen) << chosen.explanation;
  EXPECT_EQ(chosen.point.freedom, 6.0);
  // Scaling the data by a power of two changes no bit, by another factor not the choice.
  for (const double factor : {std::ldexp(1.0, 30), 1e-12, 1e12}) {
    std::vector<double> scaled = power;
    for (double& value : scaled) value *= factor * factor;
    data.power = scaled;
    EXPECT_EQ(rule.choose(kTruncated, data).parameter(), chosen.parameter());
  }
}

TEST(AdaptiveLCurve, SaysWhereThereIsNoCorner) {
  // A single component: the curve is a line.
  const SpectralOperator problem({1.0}, {1.0}, {}, 1);
  const std::vector<double> power = {1.0};
  SpectralData data;
  data.problem = &problem;
  data.power = power;
  const LCurveAdaptive rule({.curve = {.lowest = 0.1, .highest = 10.0, .measure = "solution"}});
  const auto chosen = rule.choose(kTruncated, data);
  EXPECT_EQ(chosen.status, ChoiceStatus::kNotReached);
  EXPECT_THAT(chosen.warnings, testing::ElementsAre(testing::HasSubstr("no corner")));
}

TEST(Evidence, IsTheMarginalLikelihood) {
  const IllPosedProblem problem = deriv2(12);
  const SvdProblem svd(problem.matrix);
  std::vector<double> draw(12);
  fill_standard_normal(StreamKey(7), draw);
  Eigen::VectorXd data = problem.noise_free;
  for (int i = 0; i < 12; ++i) data[i] += 0.003 * draw[static_cast<std::size_t>(i)];
  const auto solution = svd.solve(data, kTikhonov, Evidence({.curve = {.measure = "solution"}}));
  for (std::size_t j = 0; j < solution.choice.curve.size(); j += 37) {
    const CurvePoint& point = solution.choice.curve[j];
    // Covariance I + A Aᵀ/λ² up to the noise level, which is eliminated.
    const Eigen::MatrixXd covariance =
        Eigen::MatrixXd::Identity(12, 12) +
        problem.matrix * problem.matrix.transpose() / (point.parameter * point.parameter);
    const double expected = 12.0 * std::log(data.dot(covariance.ldlt().solve(data))) +
                            std::log(covariance.determinant());
    // The condition of the covariance, below 1e6 here, times rounding.
    EXPECT_NEAR(point.criterion, expected, 1e-8 * std::abs(expected) + 1e-8);
  }
}

TEST(DisagreementOf, NamesTheRulesThatLieFarAway) {
  ChosenParameter choice;
  choice.status = ChoiceStatus::kChosen;
  for (int j = 0; j < 9; ++j) {
    // r²/(m − d)² with its minimum at 1e-2; the product has it there too.
    const double parameter = std::pow(10.0, -4.0 + 0.5 * j);
    choice.curve.push_back({.parameter = parameter,
                            .residual_norm = 1.0 + std::pow(std::log10(parameter) + 2.0, 2),
                            .solution_norm = 1.0});
  }
  choice.curve.push_back({.parameter = 10.0, .residual_norm = 30.0, .solution_norm = 1.0});
  choice.point.parameter = 1e-2;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(disagreement_of(choice, 100, unknown), "");
  choice.point.parameter = 0.5e-3;
  const std::string text = disagreement_of(choice, 100, unknown);
  EXPECT_THAT(text, testing::HasSubstr("cross validation 0.01"));
  EXPECT_THAT(text, testing::HasSubstr("minimal product 0.01"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("discrepancy")));
  EXPECT_THAT(disagreement_of(choice, 100, 0.55), testing::HasSubstr("discrepancy principle 1"));
  choice.status = ChoiceStatus::kGiven;
  EXPECT_EQ(disagreement_of(choice, 100, unknown), "");
}

}  // namespace
}  // namespace modcal::parameter_rules_test
