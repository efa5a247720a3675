// Rules and regularizers on problems whose answer is known in closed form, and on ill-posed
// problems with known solutions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "benchmarks/problems/ill_posed_problems.hpp"
#include "libinverse/cumulative_periodogram.hpp"
#include "libinverse/discrepancy.hpp"
#include "libinverse/evidence.hpp"
#include "libinverse/fixed_parameter.hpp"
#include "libinverse/generalized_cross_validation.hpp"
#include "libinverse/l_curve.hpp"
#include "libinverse/l_curve_adaptive.hpp"
#include "libinverse/minimal_product.hpp"
#include "libinverse/one_sided_inversion.hpp"
#include "libinverse/predictive_risk.hpp"
#include "libinverse/quasi_optimality.hpp"
#include "libinverse/robust_cross_validation.hpp"
#include "libinverse/rule_disagreement.hpp"
#include "libinverse/svd_problem.hpp"
#include "libinverse/tikhonov.hpp"
#include "libinverse/truncated_svd.hpp"
#include "libinverse/water_level.hpp"
#include "libinverse/wiener.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal {
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
  double best = 1e-6;
  for (double l = 1e-6; l < 1.0; l *= 1.0005) {
    if (criterion(l) < criterion(best)) best = l;
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
  double expected = low;
  for (double t = low; t < high; t += 1e-3) {
    if (curvature(t) > curvature(expected)) expected = t;
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

// Definitions: A x approximates the integral with an error of the midpoint rule, h²/24 of the
// integrand's second derivative, or of order h where the kernel has a kink.
TEST(IllPosedProblems, AreDiscreteFormsOfTheirIntegrals) {
  for (const Eigen::Index n : {64, 128}) {
    const double size = static_cast<double>(n);
    const IllPosedProblem second = deriv2(n), famous = phillips(n);
    double second_error = 0.0, famous_error = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double place = (static_cast<double>(i) + 0.5) / size;
      second_error = std::max(
          second_error, std::abs(second.noise_free[i] - (place * place * place - place) / 6.0));
      const double s = -6.0 + 12.0 * place, angle = s * std::numbers::pi / 3.0;
      const double exact = (6.0 - std::abs(s)) * (1.0 + 0.5 * std::cos(angle)) +
                           4.5 / std::numbers::pi * std::sin(std::abs(angle));
      famous_error = std::max(famous_error, std::abs(famous.noise_free[i] - exact));
    }
    EXPECT_LT(second_error, 0.5 / (size * size));
    EXPECT_LT(famous_error, 60.0 / (size * size));
  }
  // ∫ k(t) dt over [0, 1] = erfc(1/2): the heat that has arrived, κ = 1.
  EXPECT_NEAR(heat(400).matrix.row(399).sum(), std::erfc(0.5), 1e-5);
}

Eigen::VectorXd noisy(const IllPosedProblem& problem, double level, std::uint64_t seed,
                      double& rms) {
  const auto n = static_cast<std::size_t>(problem.noise_free.size());
  rms = level * std::sqrt(problem.noise_free.squaredNorm() / static_cast<double>(n));
  std::vector<double> draw(n);
  fill_standard_normal(StreamKey(seed), draw);
  Eigen::VectorXd data = problem.noise_free;
  for (std::size_t i = 0; i < n; ++i) data[static_cast<Eigen::Index>(i)] += rms * draw[i];
  return data;
}

double error_of(const IllPosedProblem& problem, const Eigen::VectorXd& x) {
  return (x - problem.solution).norm() / problem.solution.norm();
}

class EveryProblem : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(IllPosed, EveryProblem, testing::Values(0, 1, 2, 3));

// Every rule, every regularizer: a solution whose error is between that of the best parameter and
// far below that of no regularization, except where the result warns.
TEST_P(EveryProblem, EveryPairImprovesOnDirectInversionOrWarns) {
  const IllPosedProblem problem = ill_posed_problems(48)[GetParam()];
  double rms = 0.0;
  const Eigen::VectorXd data = noisy(problem, 0.01, 5, rms);
  for (const auto& entry : Regularizer::registry()) {
    const auto regularizer = Choice<Regularizer>(entry.name).make();
    if (!regularizer->has_parameter()) continue;
    const SvdProblem svd(problem.matrix, *regularizer, problem.step);
    const auto error_at = [&](double parameter) {
      const FixedParameter fixed(
          {.value = parameter, .curve = {.points = 0, .measure = "solution"}});
      return error_of(problem, svd.solve(data, *regularizer, fixed).x);
    };
    const double direct = error_at(0.0);
    double best = direct;
    for (double level = svd.problem().sigma()[0]; level > 1e-8; level *= 0.9) {
      best = std::min(best, error_at(level));
    }
    const auto check = [&](const char* name, const ParameterChoice& rule) {
      const SvdSolution solution = svd.solve(data, *regularizer, rule, rms);
      const double error = error_of(problem, solution.x);
      EXPECT_GT(error, 0.95 * best) << entry.name << ' ' << name;  // the scan's step
      if (!solution.choice.warnings.empty()) return;
      EXPECT_LT(error, std::sqrt(best * direct)) << entry.name << ' ' << name;
    };
    const CurveOptions curve = {.measure = "solution"};
    check("minimal_product", MinimalProduct({.curve = curve}));
    check("l_curve", LCurve({.curve = curve}));
    check("l_curve_adaptive", LCurveAdaptive({.curve = curve}));
    check("gcv", GeneralizedCrossValidation({.curve = curve}));
    check("robust_gcv", RobustCrossValidation({.curve = curve}));
    check("discrepancy", Discrepancy({.curve = curve}));
    check("quasi_optimality", QuasiOptimality({.curve = curve}));
    check("ncp", CumulativePeriodogram({.curve = curve}));
    check("upre", PredictiveRisk({.curve = curve}));
    check("evidence", Evidence({.curve = curve}));
  }
}

// FFT problem of orders 1 and 2 against the normal equations of a circulant matrix.
class TikhonovOrder : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, TikhonovOrder, testing::Values(0, 1, 2));

TEST_P(TikhonovOrder, HoldsTheDerivativeOfASignalDown) {
  const std::size_t samples = 16;
  std::vector<Complex> transfer(samples / 2 + 1), receptance(samples / 2 + 1, 1.0);
  for (std::size_t k = 0; k < transfer.size(); ++k) {
    transfer[k] = std::polar(1.0 / (1.0 + static_cast<double>(k)), 0.3 * static_cast<double>(k));
  }
  transfer.back() = transfer.back().real() + 0.1;
  const double rate = 1000.0;
  const OneSidedInversion inversion(transfer, receptance, samples, rate);
  std::vector<double> reaction(samples);
  fill_standard_normal(StreamKey(1), reaction);
  const Tikhonov regularizer({.order = GetParam()});
  const double level = 0.2;
  const FixedParameter fixed({.value = level, .curve = {.points = 0}});
  const InversionResult result =
      inversion.invert(reaction, {regularizer, fixed, {.force = true, .force_spectrum = true}});
  const FrequencyGrid grid = FrequencyGrid::of_record(samples, rate);
  double square = 0.0;
  for (std::size_t k = 1; k < grid.bins; ++k) square += grid.omega(k) * grid.omega(k);
  const double reference = std::sqrt(square / static_cast<double>(grid.bins - 1));
  const std::vector<Complex> measured = RealFft(samples).forward(reaction);
  for (std::size_t k = 1; k < grid.bins; ++k) {
    const double penalty = level * std::pow(grid.omega(k) / reference, GetParam());
    const Complex expected =
        std::conj(transfer[k]) * measured[k] / (std::norm(transfer[k]) + penalty * penalty);
    EXPECT_LT(std::abs(result.force_spectrum[k] - expected), 1e-12) << k;
  }
}

// ‖b − A x‖² + λ² ‖p C x‖² by its normal equations, C the cosine transform.
Eigen::VectorXd by_normal_equations(const IllPosedProblem& problem, const Regularizer& regularizer,
                                    const Eigen::VectorXd& data, double level) {
  const Eigen::Index n = problem.matrix.cols();
  Eigen::MatrixXd penalty(n, n);
  double square = 0.0;
  const auto omega = [&](Eigen::Index k) {
    return std::numbers::pi * static_cast<double>(k) / (static_cast<double>(n) * problem.step);
  };
  for (Eigen::Index k = 1; k < n; ++k) square += omega(k) * omega(k);
  const double reference = std::sqrt(square / static_cast<double>(n - 1));
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index j = 0; j < n; ++j) {
      penalty(k, j) = regularizer.penalty(omega(k), reference) *
                      std::sqrt((k == 0 ? 1.0 : 2.0) / static_cast<double>(n)) *
                      std::cos(omega(k) * problem.step * (static_cast<double>(j) + 0.5));
    }
  }
  const Eigen::MatrixXd normal =
      problem.matrix.transpose() * problem.matrix + level * level * penalty.transpose() * penalty;
  return normal.ldlt().solve(problem.matrix.transpose() * data);
}

TEST_P(TikhonovOrder, HoldsTheDerivativeOfAMatrixSolutionDown) {
  const IllPosedProblem problem = phillips(32);
  double rms = 0.0;
  const Eigen::VectorXd data = noisy(problem, 0.01, 3, rms);
  const Tikhonov regularizer({.order = GetParam()});
  const SvdProblem svd(problem.matrix, regularizer, problem.step);
  const double level = 0.3;
  const FixedParameter fixed({.value = level, .curve = {.points = 0, .measure = "solution"}});
  const SvdSolution solution = svd.solve(data, regularizer, fixed);
  const Eigen::VectorXd expected = by_normal_equations(problem, regularizer, data, level);
  // Normal equations square the condition, about 1e4 with this λ.
  EXPECT_LT((solution.x - expected).norm(), 1e-8 * expected.norm());
  EXPECT_NEAR(solution.choice.point.residual_norm, (data - problem.matrix * expected).norm(),
              1e-7 * data.norm());
}

TEST(WienerFilter, OfAMatrixIsTheLinearEstimateOfItsPrior) {
  const IllPosedProblem problem = deriv2(24);
  double rms = 0.0;
  const Eigen::VectorXd data = noisy(problem, 0.02, 4, rms);
  const WienerFilter regularizer({.corner = 0.8});
  const SvdProblem svd(problem.matrix, regularizer, problem.step);
  const FixedParameter fixed({.value = 0.01, .curve = {.points = 0, .measure = "solution"}});
  const Eigen::VectorXd expected = by_normal_equations(problem, regularizer, data, 0.01);
  EXPECT_LT((svd.solve(data, regularizer, fixed).x - expected).norm(), 1e-8 * expected.norm());
}

TEST(SvdProblem, RefusesAnotherPenaltyThanItIsPreparedFor) {
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(4, 4);
  const Eigen::VectorXd data = Eigen::VectorXd::Ones(4);
  const GeneralizedCrossValidation rule({.curve = {.measure = "solution"}});
  const Tikhonov first({.order = 1}), second({.order = 2});
  EXPECT_THROW(SvdProblem(matrix).solve(data, first, rule), InvalidInput);
  EXPECT_THROW(SvdProblem(matrix, first, 1.0).solve(data, second, rule), InvalidInput);
  EXPECT_THROW(SvdProblem(matrix, first, 0.0), InvalidInput);
  EXPECT_THROW(Tikhonov({.order = 3}), InvalidInput);
  EXPECT_THROW(WienerFilter({.corner = 0.0}), InvalidInput);
  // One unknown is its own mean: no derivative holds it down.
  const SvdProblem lonely(Eigen::MatrixXd::Constant(3, 1, 2.0), first, 1.0);
  EXPECT_NEAR(lonely.solve(Eigen::Vector3d(1.0, 2.0, 3.0), first, rule).x[0], 1.0, 1e-14);
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
}  // namespace modcal
