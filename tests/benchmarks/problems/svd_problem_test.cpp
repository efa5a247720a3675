#include "benchmarks/problems/svd_problem.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"
#include "libsim/base/error.hpp"

namespace modcal::svd_problem_test {
namespace {

constexpr int kSize = 64;

// Image restoration problem of Shaw (1972) in the discretization of Hansen, Regularization Tools.
struct Shaw {
  Shaw() : matrix(kSize, kSize), x(kSize) {
    const double h = std::numbers::pi / kSize;
    for (int i = 0; i < kSize; ++i) {
      const double s = -std::numbers::pi / 2 + (i + 0.5) * h;
      x[i] = 2 * std::exp(-6 * (s - 0.8) * (s - 0.8)) + std::exp(-2 * (s + 0.5) * (s + 0.5));
      for (int j = 0; j < kSize; ++j) {
        const double t = -std::numbers::pi / 2 + (j + 0.5) * h;
        const double u = std::numbers::pi * (std::sin(s) + std::sin(t));
        const double sinc = std::abs(u) < 1e-12 ? 1.0 : std::sin(u) / u;
        matrix(i, j) = h * std::pow(std::cos(s) + std::cos(t), 2) * sinc * sinc;
      }
    }
    clean = matrix * x;
  }

  // Deterministic noise of norm delta |b|.
  Eigen::VectorXd noise(double delta) const {
    Eigen::VectorXd w(kSize);
    for (int i = 0; i < kSize; ++i) {
      const double v = 43758.5453 * std::sin(12.9898 * (i + 1));
      w[i] = v - std::floor(v) - 0.5;
    }
    return delta * clean.norm() / w.norm() * w;
  }

  Eigen::MatrixXd matrix;
  Eigen::VectorXd x;
  Eigen::VectorXd clean;
};

const Shaw& shaw() {
  static const Shaw problem;
  return problem;
}

const SvdProblem& shaw_svd() {
  static const SvdProblem problem(shaw().matrix);
  return problem;
}

// 2401 values of λ from 1e-8 σ₁ to σ₁.
CurveOptions search(std::int64_t points = 2401) {
  const double largest = shaw_svd().problem().sigma()[0];
  return {.points = points, .lowest = 1e-8 * largest, .highest = largest, .measure = "solution"};
}

std::shared_ptr<const ParameterChoice> rule_named(const std::string& name) {
  if (name == "discrepancy") return std::make_shared<Discrepancy>(Discrepancy::Options{search()});
  if (name == "minimal_product") {
    return std::make_shared<MinimalProduct>(MinimalProduct::Options{search()});
  }
  if (name == "upre") return std::make_shared<PredictiveRisk>(PredictiveRisk::Options{search()});
  if (name == "l_curve_curvature") {
    return std::make_shared<LCurve>(LCurve::Options{.curve = search(), .span = 0.0});
  }
  return std::make_shared<GeneralizedCrossValidation>(
      GeneralizedCrossValidation::Options{search()});
}

const Tikhonov& tikhonov() {
  static const Tikhonov regularizer{Tikhonov::Options{}};
  return regularizer;
}

SvdSolution solve(double delta, const ParameterChoice& rule) {
  const Eigen::VectorXd noise = shaw().noise(delta);
  return shaw_svd().solve(shaw().clean + noise, tikhonov(), rule,
                          noise.norm() / std::sqrt(static_cast<double>(kSize)));
}

double relative_error(const SvdSolution& solution) {
  return (solution.x - shaw().x).norm() / shaw().x.norm();
}

// The solution closest to the truth of all on the grid.
SvdSolution optimum(double delta) {
  const SvdSolution any = solve(delta, *rule_named("minimal_product"));
  SvdSolution best = any;
  for (const CurvePoint& point : any.choice.curve) {
    const GivenParameter fixed({.value = point.parameter, .curve = search(0)});
    SvdSolution solution = solve(delta, fixed);
    if (relative_error(solution) < relative_error(best)) best = std::move(solution);
  }
  return best;
}

struct Row {
  double delta;
  const char* rule;
  const char* error;
  const char* lambda;  // over σ₁, as many digits as the reference prints
};

// Hansen's problem, solved independently; relative error and λ/σ₁ per rule, as printed there.
constexpr Row kReference[] = {
    {0.1, "optimum", "0.1889", "1.18e-01"},
    {0.1, "discrepancy", "0.1908", "1.07e-01"},
    {0.1, "gcv", "0.3080", "3.55e-02"},
    {0.1, "upre", "0.3010", "3.72e-02"},
    {0.1, "minimal_product", "0.2205", "7.36e-02"},
    {0.1, "l_curve_curvature", "0.2728", "4.6e-02"},
    {0.01, "optimum", "0.1519", "1.74e-02"},
    {0.01, "discrepancy", "0.1588", "3.41e-02"},
    {0.01, "gcv", "0.1572", "1.17e-02"},
    {0.01, "upre", "0.1554", "1.25e-02"},
    {0.01, "minimal_product", "0.1807", "6.97e-03"},
    {0.01, "l_curve_curvature", "0.1817", "6.9e-03"},
    {0.001, "optimum", "0.0587", "2.91e-03"},
    {0.001, "discrepancy", "0.0702", "5.80e-03"},
    {0.001, "gcv", "0.0744", "1.33e-03"},
    {0.001, "upre", "0.0717", "1.43e-03"},
    {0.001, "minimal_product", "0.0977", "6.81e-04"},
    {0.001, "l_curve_curvature", "0.1062", "4.7e-04"},
};

class ShawReference : public testing::TestWithParam<Row> {};
INSTANTIATE_TEST_SUITE_P(Rows, ShawReference, testing::ValuesIn(kReference));

TEST_P(ShawReference, IsReproducedToThePrintedDigits) {
  const Row& row = GetParam();
  const std::string rule = row.rule;
  const SvdSolution solution =
      rule == "optimum" ? optimum(row.delta) : solve(row.delta, *rule_named(rule));
  const bool chosen = solution.choice.status == ChoiceStatus::kChosen;
  EXPECT_EQ(chosen, rule != "optimum");
  EXPECT_EQ(fmt::format("{:.4f}", relative_error(solution)), row.error) << row.delta << rule;
  const double share = solution.choice.parameter() / shaw_svd().problem().sigma()[0];
  const bool three_digits = std::string(row.lambda).size() == 8;
  EXPECT_EQ(three_digits ? fmt::format("{:.2e}", share) : fmt::format("{:.1e}", share), row.lambda)
      << row.delta << rule;
}

TEST(Shaw, IsTheProblemMeant) {
  EXPECT_EQ(fmt::format("{:.10g}", shaw_svd().problem().sigma()[0]), "2.993309662");
  EXPECT_EQ(fmt::format("{:.9g}", shaw_svd().problem().sigma()[1]), "1.85675011");
  EXPECT_EQ(fmt::format("{:.10g}", shaw().x.norm()), "7.985636877");
  EXPECT_EQ(fmt::format("{:.10g}", shaw().clean.norm()), "18.64919225");
}

TEST(SvdProblem, CurveHoldsTheNormsOfTheSolution) {
  const SvdSolution solution = solve(0.01, *rule_named("gcv"));
  const Eigen::VectorXd data = shaw().clean + shaw().noise(0.01);
  const CurvePoint& point = solution.choice.point;
  EXPECT_NEAR(point.solution_norm, solution.x.norm(), 1e-11 * solution.x.norm());
  // Compacted sums to 1e-11, and roundings of A x of 1e-15 |b| in a residual of 0.01 |b|.
  const double residual = (data - shaw().matrix * solution.x).norm();
  EXPECT_NEAR(point.residual_norm, residual, 1e-11 * residual);
}

TEST(SvdProblem, KeepsTheDataOutsideTheRangeInTheResidual) {
  // Fit of a constant to (1, 2, 3, 6): mean 3, residual² 14 (worked by hand).
  const SvdProblem problem(Eigen::MatrixXd::Ones(4, 1));
  const Eigen::Vector4d data(1, 2, 3, 6);
  const auto none = Choice<Regularizer>("none").make();
  const MinimalProduct rule({.curve = {.measure = "solution"}});
  const SvdSolution solution = problem.solve(data, *none, rule);
  EXPECT_NEAR(solution.x[0], 3.0, 1e-14);
  EXPECT_NEAR(solution.choice.point.residual_norm, std::sqrt(14.0), 1e-14);
  EXPECT_EQ(solution.choice.status, ChoiceStatus::kNoParameter);
}

TEST(SvdProblem, KnowsNoDerivative) {
  const MinimalProduct rule{MinimalProduct::Options{}};
  EXPECT_THROW(shaw_svd().solve(shaw().clean, tikhonov(), rule), InvalidInput);
}

TEST(SvdProblem, RefusesWhatIsNotFinite) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(2, 2);
  matrix(1, 0) = std::nan("");
  EXPECT_THROW(SvdProblem{matrix}, InvalidInput);
  EXPECT_THROW(SvdProblem{Eigen::MatrixXd(0, 3)}, InvalidInput);
  Eigen::VectorXd data = shaw().clean;
  data[3] = std::nan("");
  EXPECT_THROW(shaw_svd().solve(data, tikhonov(), *rule_named("gcv")), InvalidInput);
  EXPECT_THROW(shaw_svd().solve(Eigen::VectorXd::Ones(3), tikhonov(), *rule_named("gcv")),
               InvalidInput);
}

}  // namespace
}  // namespace modcal::svd_problem_test
