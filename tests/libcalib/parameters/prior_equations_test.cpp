#include "libcalib/parameters/prior_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace modcal::prior_equations_test {
namespace {

using Index = Eigen::Index;

constexpr Index kModes = 6;

// Frequencies that scatter by 1e-5, the last by 1e-2.
LawScatter scatter() {
  LawScatter law{.widths = Eigen::VectorXd::Constant(kModes, 1e-5), .inharmonicity = 1e-4};
  law.widths[kModes - 1] = 1e-2;
  return law;
}

// Measured frequencies, correlated, and f_n = law + scatter: the law by generalized least squares.
TEST(PriorEquations, LawIsThatOfLeastSquares) {
  PriorEquations equations(kModes);
  Eigen::VectorXd reference(kModes), measured(kModes);
  Eigen::MatrixXd slopes(kModes, 2);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(kModes, kModes, 4e-11);
  for (Index i = 0; i < kModes; ++i) {
    const double n = static_cast<double>(i + 1), stiff = 1.0 + 1e-4 * n * n;
    reference[i] = std::log(200.0 * n * std::sqrt(stiff));
    measured[i] = 1e-5 * std::sin(3.0 * n);
    slopes.row(i) << 1.0, 0.5 * n * n / stiff;
    covariance(i, i) += 1e-10 * n;
  }
  equations.add_scatter(scatter(), reference);
  // What the data say and the statements about the law: one posterior of θ.
  const QuadraticPrior prior = equations.solve();
  const Eigen::MatrixXd data = covariance.inverse();
  const Eigen::MatrixXd posterior = (data + prior.precision).inverse();
  const Eigen::VectorXd theta = posterior * (data * measured + prior.precision * prior.mean);
  const LawPosterior law = equations.law(theta, posterior);

  const Eigen::MatrixXd total =
      covariance + Eigen::MatrixXd(scatter().widths.cwiseAbs2().asDiagonal());
  const Eigen::MatrixXd weight = total.inverse();
  const Eigen::Matrix2d expected = (slopes.transpose() * weight * slopes).inverse();
  const Eigen::Vector2d change = expected * slopes.transpose() * weight * measured;
  // The posterior precision loses digits to that of the scatter: 1e10 of 1e16.
  EXPECT_NEAR(law.mean[0], std::log(200.0) + change[0], 1e-4 * std::sqrt(expected(0, 0)));
  EXPECT_NEAR(law.mean[1], 1e-4 + change[1], 1e-4 * std::sqrt(expected(1, 1)));
  EXPECT_NEAR(law.covariance(0, 0) / expected(0, 0), 1.0, 1e-4);
  EXPECT_NEAR(law.covariance(1, 1) / expected(1, 1), 1.0, 1e-4);
}

}  // namespace
}  // namespace modcal::prior_equations_test
