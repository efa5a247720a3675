#include "libcalib/likelihood/newton_step.hpp"

#include "libcalib/likelihood/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

bool positive_definite(const Eigen::MatrixXd& matrix) {
  // Scaled to a unit diagonal, so that units do not decide.
  if ((matrix.diagonal().array() <= 0.0).any()) return false;
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  scaled.diagonal().array() -= 1e-10;
  return PositiveSolver(scaled).factor().info() == Eigen::Success;
}

// The factor of a matrix scaled to a unit diagonal: units differ by many powers of ten.
struct UnitDiagonal {
  explicit UnitDiagonal(const Eigen::MatrixXd& matrix)
      : scale(matrix.diagonal().cwiseSqrt().cwiseInverse()), factor(scaled(matrix)) {}
  Eigen::MatrixXd scaled(const Eigen::MatrixXd& matrix) const {
    return scale.asDiagonal() * matrix * scale.asDiagonal();
  }
  template <typename Right>
  Right solve(const Right& right) const {
    return scale.asDiagonal() * factor.solve(scale.asDiagonal() * right);
  }
  Eigen::VectorXd scale;
  SemidefiniteSolver factor;
};

Eigen::MatrixXd hessian_of(const LikelihoodPoint& point, const NewtonOptions& options) {
  return debiased_hessian(2.0 * point.information, 2.0 * options.noise, options.prior);
}

}  // namespace

Eigen::MatrixXd padded_prior(const Eigen::MatrixXd& prior, Eigen::Index size) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  result.topLeftCorner(prior.rows(), prior.cols()) = prior;
  return result;
}

Eigen::MatrixXd debiased_hessian(const Eigen::MatrixXd& information, const Eigen::MatrixXd& noise,
                                 const Eigen::MatrixXd& prior) {
  const Eigen::MatrixXd q = padded_prior(prior, information.rows());
  Eigen::MatrixXd full = information + q;
  if (noise.size() == 0 || noise.isZero(0.0)) return full;
  double share = 1.0;
  for (int i = 0; i < 60; ++i, share *= 0.9) {
    Eigen::MatrixXd hessian = full - share * noise;
    if (positive_definite(hessian - kPriorShare * q)) return hessian;
  }
  return full;
}

double taken_by_fit(const LikelihoodPoint& point, const NewtonOptions& options,
                    const Eigen::MatrixXd& whole) {
  const UnitDiagonal hessian(hessian_of(point, options));
  const double followed = hessian.factor.solve(hessian.scaled(point.information)).trace();
  return 4.0 * followed - 2.0 * whole.cwiseProduct(fit_covariance(point, options)).sum();
}

Eigen::MatrixXd fit_response(const LikelihoodPoint& point, const NewtonOptions& options,
                             const Eigen::MatrixXd& change) {
  return UnitDiagonal(hessian_of(point, options)).solve(change);
}

Eigen::MatrixXd fit_covariance(const LikelihoodPoint& point, const NewtonOptions& options) {
  const UnitDiagonal hessian(hessian_of(point, options));
  const Eigen::Index size = hessian.scale.size();
  const Eigen::MatrixXd inverse =
      hessian.scaled(hessian.factor.solve(Eigen::MatrixXd::Identity(size, size)));
  const Eigen::MatrixXd score = 2.0 * point.twice_weighted + padded_prior(options.prior, size);
  return inverse * score * inverse;
}

LawPosterior law_of_step(const LawStatements& statements, const LikelihoodPoint& at,
                         const Eigen::VectorXd& theta, NewtonOptions options,
                         const Eigen::MatrixXd& more) {
  const Eigen::MatrixXd there = hessian_of(at, options);
  const QuadraticPrior law = statements.law.solve(), wide = statements.wide.solve();
  options.prior = wide.precision;
  const Eigen::MatrixXd alone = hessian_of(at, options);
  const Eigen::MatrixXd error = there * more * there;  // C
  const UnitDiagonal both(alone + error);
  // P = A (A + C)⁻¹, by its transpose.
  const Eigen::MatrixXd weight = both.solve(alone).transpose();
  const Eigen::MatrixXd tie = law.precision - wide.precision;
  const UnitDiagonal hessian(weight * alone + tie);
  const Eigen::VectorXd pull = wide.precision * (theta - wide.mean);
  const Eigen::VectorXd further = law.precision * (theta - law.mean) - pull;
  const Eigen::VectorXd step =
      hessian.solve(Eigen::VectorXd(weight * (2.0 * at.slope + pull) + further));
  const Eigen::MatrixXd score = 2.0 * at.twice_weighted + wide.precision + error;
  const Eigen::MatrixXd half =
      hessian.solve(Eigen::MatrixXd(weight * score * weight.transpose() + tie));
  return statements.law.law(theta - step, hessian.solve(Eigen::MatrixXd(half.transpose())));
}

}  // namespace modcal
