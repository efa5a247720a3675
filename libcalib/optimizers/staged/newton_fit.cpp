#include "libcalib/optimizers/staged/newton_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace modcal {
namespace {

// Q padded with zeros for the unknowns that have no prior.
Eigen::MatrixXd padded(const Eigen::MatrixXd& prior, Eigen::Index size) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  result.topLeftCorner(prior.rows(), prior.cols()) = prior;
  return result;
}

// The information itself is positive: what is left in any direction is no less than the prior
// there, save for the scatter of what noise adds. A direction with less than this of it would be
// said to be worse known than before the record.
constexpr double kPriorShare = 0.1;

bool positive_definite(const Eigen::MatrixXd& matrix) {
  // Scaled to a unit diagonal, so that units do not decide.
  if ((matrix.diagonal().array() <= 0.0).any()) return false;
  const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  scaled.diagonal().array() -= 1e-10;
  return scaled.llt().info() == Eigen::Success;
}

struct Objective2 {
  double value;
  Eigen::VectorXd gradient;
};

Objective2 with_prior(const LikelihoodPoint& point, const Eigen::VectorXd& theta,
                      const Eigen::MatrixXd& prior, const Eigen::VectorXd& mean) {
  const Eigen::VectorXd change = mean.size() == 0 ? theta : theta - mean;
  const Eigen::VectorXd pull = prior * change;
  return {point.cost + 0.5 * change.dot(pull), 2.0 * point.slope + pull};
}

struct Step {
  Eigen::VectorXd move;
  double decrease = 0.0;
};

Step newton_step(const NewtonFit& fit, const Objective2& at, double damping,
                 const NewtonOptions& options) {
  Eigen::MatrixXd hessian = debiased_hessian(fit.point.information, options);
  const Eigen::VectorXd scale = hessian.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  hessian = scale.asDiagonal() * hessian * scale.asDiagonal();
  hessian.diagonal().array() += damping + 1e-12;
  Step step{-(scale.asDiagonal() * hessian.ldlt().solve(scale.asDiagonal() * at.gradient))};
  step.decrease = -step.move.dot(at.gradient);
  return step;
}

// The factor of a matrix scaled to a unit diagonal: units differ by many powers of ten.
struct UnitDiagonal {
  explicit UnitDiagonal(const Eigen::MatrixXd& matrix)
      : scale(matrix.diagonal().cwiseSqrt().cwiseInverse()), factor(scaled(matrix)) {}
  Eigen::MatrixXd scaled(const Eigen::MatrixXd& matrix) const {
    return scale.asDiagonal() * matrix * scale.asDiagonal();
  }
  Eigen::VectorXd scale;
  Eigen::LDLT<Eigen::MatrixXd> factor;
};

// A long step is likely to be taken and the information needed where it ends.
constexpr double kLong = 1.0;

// Of its standard deviation: an unknown that moved less keeps its row of the information. Even
// where a column is another one after a standard deviation, a step is then off by a twenty-fifth of
// one, and the slope, which is exact, has the next step make up for it.
constexpr double kMoved = 0.2;

struct Trial {
  LikelihoodPoint point;
  Eigen::VectorXd formed;  // where each unknown's row of the information is from; empty: no rows
};

Eigen::VectorXd deviations(const LikelihoodPoint& point, const NewtonOptions& options) {
  const UnitDiagonal hessian(debiased_hessian(point.information, options));
  const Eigen::Index size = hessian.scale.size();
  const Eigen::MatrixXd inverse = hessian.factor.solve(Eigen::MatrixXd::Identity(size, size));
  return hessian.scale.cwiseProduct(inverse.diagonal().cwiseMax(0.0).cwiseSqrt());
}

std::vector<std::size_t> moved_unknowns(const Eigen::VectorXd& moves, const LikelihoodPoint& point,
                                        const NewtonOptions& options) {
  const Eigen::VectorXd least = kMoved * deviations(point, options);
  std::vector<std::size_t> moved;
  for (Eigen::Index i = 0; i < moves.size(); ++i) {
    if (std::abs(moves[i]) > least[i]) moved.push_back(static_cast<std::size_t>(i));
  }
  return moved;
}

// The information of fit.point with the rows found at `theta`.
Trial with_rows(LikelihoodPoint point, const Eigen::VectorXd& theta,
                std::span<const std::size_t> moved, const Eigen::VectorXd& formed,
                const NewtonFit& fit) {
  const Eigen::MatrixXd rows = std::move(point.information);
  Trial result{.point = std::move(point), .formed = formed};
  result.point.information = fit.point.information;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(moved[i]);
    result.point.information.row(row) = rows.row(static_cast<Eigen::Index>(i));
    result.point.information.col(row) = rows.row(static_cast<Eigen::Index>(i)).transpose();
    result.formed[row] = theta[row];
  }
  return result;
}

Trial try_slope(const FitTarget& target, const Eigen::VectorXd& theta, NewtonFit& fit) {
  if (target.poll) target.poll();
  ++fit.evaluations;
  if (!target.slope) return {target.evaluate(theta), theta};
  ++fit.slopes;
  return {target.slope(theta), {}};
}

// Rows of unknowns that have moved; where the fit stands and none has, nothing is to be found.
Trial try_information(const FitTarget& target, const Eigen::VectorXd& theta,
                      const NewtonOptions& options, const Eigen::VectorXd& formed, NewtonFit& fit) {
  std::vector<std::size_t> moved;
  if (target.rows) {
    moved = moved_unknowns(theta - formed, fit.point, options);
    if (moved.empty() && theta == fit.theta) return {.point = fit.point, .formed = formed};
  }
  if (target.poll) target.poll();
  ++fit.evaluations;
  LikelihoodPoint point = target.rows ? target.rows(theta, moved) : target.evaluate(theta);
  if (point.information.rows() == point.information.cols()) return {std::move(point), theta};
  ++fit.partial;
  return with_rows(std::move(point), theta, moved, formed, fit);
}

}  // namespace

Eigen::MatrixXd debiased_hessian(const Eigen::MatrixXd& information, const NewtonOptions& options) {
  const Eigen::MatrixXd prior = padded(options.prior, information.rows());
  const Eigen::MatrixXd full = 2.0 * information + prior;
  if (options.noise.size() == 0) return full;
  double share = 1.0;
  for (int i = 0; i < 60; ++i, share *= 0.9) {
    const Eigen::MatrixXd hessian = full - 2.0 * share * options.noise;
    if (positive_definite(hessian - kPriorShare * prior)) return hessian;
  }
  return full;
}

double taken_by_fit(const LikelihoodPoint& point, const NewtonOptions& options) {
  const UnitDiagonal hessian(debiased_hessian(point.information, options));
  return 2.0 * hessian.factor.solve(hessian.scaled(point.information)).trace();
}

Eigen::MatrixXd fit_covariance(const LikelihoodPoint& point, const NewtonOptions& options) {
  const UnitDiagonal hessian(debiased_hessian(point.information, options));
  const Eigen::Index size = hessian.scale.size();
  const Eigen::MatrixXd inverse =
      hessian.scaled(hessian.factor.solve(Eigen::MatrixXd::Identity(size, size)));
  const Eigen::MatrixXd score = 2.0 * point.twice_weighted + padded(options.prior, size);
  return inverse * score * inverse;
}

NewtonFit newton_fit(const FitTarget& target, const Eigen::VectorXd& start,
                     const NewtonOptions& options) {
  const Eigen::MatrixXd prior = padded(options.prior, start.size());
  NewtonFit fit{.theta = start};
  if (target.poll) target.poll();
  fit.point = options.at_start ? *options.at_start : target.evaluate(start);
  fit.evaluations = options.at_start ? 0 : 1;
  Eigen::VectorXd formed = start;
  Objective2 at = with_prior(fit.point, start, prior, options.prior_mean);
  fit.objective = at.value;
  double damping = 0.0;
  bool stale = false;  // the information is that of the point before
  for (std::size_t count = 0; count < options.steps; ++count) {
    Step step = newton_step(fit, at, damping, options);
    // Half the tolerance: the information changes less than that in a step.
    if (stale && !(step.decrease < 0.5 * options.tolerance && damping < 0.1)) {
      Trial here = try_information(target, fit.theta, options, formed, fit);
      fit.point.information = std::move(here.point.information);
      formed = std::move(here.formed);
      stale = false;
      step = newton_step(fit, at, damping, options);
    }
    auto& [move, decrease] = step;
    if (decrease < options.tolerance && damping < 0.1) {
      fit.converged = true;
      break;
    }
    if (target.capped > 0) {
      const double largest = move.head(target.capped).cwiseAbs().maxCoeff();
      if (largest > options.frequency_cap) move *= options.frequency_cap / largest;
    }
    const Eigen::VectorXd trial = fit.theta + move;
    bool better = false;
    if (target.admits(trial)) {
      Trial tried = damping == 0.0 && decrease > kLong
                        ? try_information(target, trial, options, formed, fit)
                        : try_slope(target, trial, fit);
      const Objective2 there = with_prior(tried.point, trial, prior, options.prior_mean);
      // The debiased step may pass the minimum of this draw by a little of its noise.
      better = there.value < at.value + 0.5 * options.tolerance;
      if (better) {
        stale = tried.formed.size() == 0;
        if (stale) tried.point.information = std::move(fit.point.information);
        if (!stale) formed = std::move(tried.formed);
        fit.theta = trial;
        fit.point = std::move(tried.point);
        at = there;
        fit.objective = at.value;
      }
    }
    damping = better ? (damping < 1e-3 ? 0.0 : 0.2 * damping) : std::max(1e-2, 6.0 * damping);
    if (damping > 1e8) break;
  }
  return fit;
}

NewtonFit newton_fit(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
                     const Eigen::VectorXd& start, const NewtonOptions& options,
                     const FitPoll& poll) {
  FitTarget target{.evaluate =
                       [&](const Eigen::VectorXd& theta) {
                         return likelihood.evaluate(unknowns.model(theta), unknowns.columns(theta));
                       },
                   .admits = [&](const Eigen::VectorXd& theta) { return unknowns.admits(theta); },
                   .capped = unknowns.is_law() ? 0 : static_cast<Eigen::Index>(unknowns.modes()),
                   .slope =
                       [&](const Eigen::VectorXd& theta) {
                         return likelihood.slope(unknowns.model(theta), unknowns.columns(theta));
                       },
                   .poll = poll};
  // The law's few columns cost less than some of their rows.
  if (!unknowns.is_law()) {
    target.rows = [&](const Eigen::VectorXd& theta, std::span<const std::size_t> wanted) {
      return likelihood.rows(unknowns.model(theta), unknowns.columns(theta), wanted);
    };
  }
  return newton_fit(target, start, options);
}

}  // namespace modcal
