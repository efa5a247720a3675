// Every rule and regularizer on ill-posed problems with known solutions.
#include "benchmarks/problems/ill_posed_problems.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "benchmarks/problems/svd_problem.hpp"
#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::ill_posed_problems_test {
namespace {

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
      const GivenParameter fixed(
          {.value = parameter, .curve = {.points = 0, .measure = "solution"}});
      return error_of(problem, svd.solve(data, *regularizer, fixed).x);
    };
    const double direct = error_at(0.0);
    double best = direct;
    double level = svd.problem().sigma()[0];
    while (level > 1e-8) {
      best = std::min(best, error_at(level));
      level *= 0.9;
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
  const GivenParameter fixed({.value = level, .curve = {.points = 0}});
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
  const GivenParameter fixed({.value = level, .curve = {.points = 0, .measure = "solution"}});
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
  const GivenParameter fixed({.value = 0.01, .curve = {.points = 0, .measure = "solution"}});
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

}  // namespace
}  // namespace modcal::ill_posed_problems_test
